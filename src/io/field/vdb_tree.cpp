// SPDX-License-Identifier: Apache-2.0
#include "io/field/vdb_tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "standoff/error.h"

namespace standoff::vdb {
namespace {

const float* stored_tile(const DistanceField& field, std::int32_t slot) {
  return field.tile_values().data() + std::size_t{DistanceField::kTileSamples} * static_cast<std::size_t>(slot);
}

// Nodes of one level from those of the level below. A node that is inside throughout is none: `inside` says so.
enum class Made { nothing, node, inside };

class Builder {
 public:
  Builder(const DistanceField& field, const AtomicFile& file)
      : field_(field),
        file_(file),
        slots_(field.slots()),
        tiles_(field.tile_count()),
        far_(static_cast<float>(field.thickness())) {}

  Tree build() {
    if (slots_.empty()) return {};
    constexpr std::int64_t kTiles = kUpperSide / kLeafSide;
    for (std::int64_t x = 0; x < tiles_.x; x += kTiles)
      for (std::int64_t y = 0; y < tiles_.y; y += kTiles)
        for (std::int64_t z = 0; z < tiles_.z; z += kTiles)
          if (upper({x, y, z}) == Made::inside) tree_.inside.push_back({8 * x, 8 * y, 8 * z});
    return std::move(tree_);
  }

 private:
  static Size3 moved(const Size3& from, const Size3& by, std::int64_t times) {
    return {from.x + times * by.x, from.y + times * by.y, from.z + times * by.z};
  }
  bool beyond(const Size3& at) const { return at.x >= tiles_.x || at.y >= tiles_.y || at.z >= tiles_.z; }

  // Nodes are named by their first tile.
  Made upper(const Size3& first) {
    return node<kUpperLog>(first, kLowerSide / kLeafSide, tree_.uppers, tree_.lowers,
                           [this](const Size3& at, std::size_t) { return lower(at); });
  }
  Made lower(const Size3& first) {
    return node<kLowerLog>(first, 1, tree_.lowers, tree_.leaves, [this](const Size3& at, std::size_t) {
      const std::int32_t slot = slots_[static_cast<std::size_t>(at.x + tiles_.x * (at.y + tiles_.y * at.z))];
      if (slot % 4096 == 0) file_.check();
      if (slot < 0) return slot == DistanceField::kInside ? Made::inside : Made::nothing;
      const Made made = stored(at, slot);
      if (made == Made::node) tree_.leaves.push_back({{8 * at.x, 8 * at.y, 8 * at.z}, slot});
      return made;
    });
  }

  // A stored tile may have nothing in the band: one that is clamped throughout is no leaf.
  Made stored(const Size3& at, std::int32_t slot) const {
    const float* const tile = stored_tile(field_, slot);
    if (std::any_of(tile, tile + DistanceField::kTileSamples, [&](float value) { return std::abs(value) < far_; }))
      return Made::node;
    const Size3& size = field_.grid().size;
    bool inside = true, outside = true;
    for (std::int64_t z = 0; z < std::min<std::int64_t>(8, size.z - 8 * at.z); ++z)
      for (std::int64_t y = 0; y < std::min<std::int64_t>(8, size.y - 8 * at.y); ++y)
        for (std::int64_t x = 0; x < std::min<std::int64_t>(8, size.x - 8 * at.x); ++x)
          (std::signbit(tile[x + 8 * (y + 8 * z)]) ? outside : inside) = false;
    return outside ? Made::nothing : inside ? Made::inside : Made::node;
  }

  template <int log, class Nodes, class Children, class Make>
  Made node(const Size3& first, std::int64_t step, Nodes& nodes, Children& children, const Make& make) {
    Node<log> made{{8 * first.x, 8 * first.y, 8 * first.z}, {}, {}, children.size(), 0};
    for (std::size_t n = 0; n < Mask<log>::kBits; ++n) {
      const Size3 at = moved(first, child_place<log>(n), step);
      if (beyond(at)) continue;
      const Made found = make(at, n);
      if (found == Made::node) made.child.set(n);
      if (found == Made::inside) made.inside.set(n);
    }
    made.count = children.size() - made.first;
    if (made.count == 0 && made.inside.none()) return Made::nothing;
    if (made.inside.count() == Mask<log>::kBits) return Made::inside;
    nodes.push_back(made);
    return Made::node;
  }

  const DistanceField& field_;
  const AtomicFile& file_;
  std::span<const std::int32_t> slots_;
  Size3 tiles_;
  float far_;
  Tree tree_;
};

}  // namespace

Tree tree_of(const DistanceField& field, const AtomicFile& file) { return Builder(field, file).build(); }

namespace {

// Returns the values of a leaf's tile. Tiles hold the thickness beyond the grid, but a caller may have written there:
// those samples become infinite, in `room`.
const float* tile_in_grid(const DistanceField& field, const Tree::Leaf& leaf, std::array<float, 512>& room) {
  const Size3& size = field.grid().size;
  const float* const tile = stored_tile(field, leaf.slot);
  if (leaf.at.x + 8 <= size.x && leaf.at.y + 8 <= size.y && leaf.at.z + 8 <= size.z) return tile;
  for (std::size_t n = 0; n < 512; ++n) {
    const bool in_grid = leaf.at.x + static_cast<std::int64_t>(n & 7) < size.x &&
                         leaf.at.y + static_cast<std::int64_t>(n >> 3 & 7) < size.y &&
                         leaf.at.z + static_cast<std::int64_t>(n >> 6) < size.z;
    room[n] = in_grid ? tile[n] : std::numeric_limits<float>::infinity();
  }
  return room.data();
}

// Four numbers at once, and their bits. Compilers do not vectorise these loops otherwise.
using Four = float __attribute__((vector_size(16)));
using FourBits = std::int32_t __attribute__((vector_size(16)));

constexpr std::int32_t kMagnitude = 0x7fffffff;

Four four(float value) { return Four{value, value, value, value}; }
FourBits bits_of(Four values) { return reinterpret_cast<FourBits>(values); }
Four load(const float* from) {
  Four all;
  std::memcpy(&all, from, sizeof all);
  return all;
}
Four magnitude(Four values) { return reinterpret_cast<Four>(bits_of(values) & kMagnitude); }
// Both return the second argument where the first is NaN.
Four min(Four a, Four b) { return a < b ? a : b; }
Four max(Four a, Four b) { return a > b ? a : b; }

// Four rows of four numbers become columns.
void transpose(std::array<Four, 4>& rows) {
  const Four a = __builtin_shufflevector(rows[0], rows[1], 0, 4, 1, 5),
             b = __builtin_shufflevector(rows[0], rows[1], 2, 6, 3, 7),
             c = __builtin_shufflevector(rows[2], rows[3], 0, 4, 1, 5),
             d = __builtin_shufflevector(rows[2], rows[3], 2, 6, 3, 7);
  rows = {__builtin_shufflevector(a, c, 0, 1, 4, 5), __builtin_shufflevector(a, c, 2, 3, 6, 7),
          __builtin_shufflevector(b, d, 0, 1, 4, 5), __builtin_shufflevector(b, d, 2, 3, 6, 7)};
}

}  // namespace

void fetch_leaf_after(const DistanceField& field, const Tree& tree, std::size_t n) {
  constexpr std::size_t kLine = 64 / sizeof(float);
  if (n + 1 == tree.leaves.size()) return;
  const float* const tile = stored_tile(field, tree.leaves[n + 1].slot);
  for (std::size_t at = 0; at < DistanceField::kTileSamples; at += kLine) __builtin_prefetch(tile + at);
}

LeafMasks leaf_masks(const DistanceField& field, const Tree::Leaf& leaf) {
  std::array<float, 512> room;
  const float* const tile = tile_in_grid(field, leaf, room);
  const auto thickness = static_cast<float>(field.thickness());
  constexpr float kMost = std::numeric_limits<float>::max();
  Four least = four(kMost), most = four(-kMost);
  LeafMasks found;
  Mask<kLeafLog> within;
  // A word of a mask holds a slice of x, so that the bits of four words are made at once.
  for (std::size_t y = 0; y < 8; ++y)
    for (std::size_t x = 0; x < 8; x += 4) {
      FourBits near_bits{}, negative_bits{};
      for (std::size_t z = 0; z < 8; ++z) {
        const Four values = load(tile + 64 * z + 8 * y + x);
        const FourBits near = magnitude(values) < four(thickness);
        near_bits |= near & (1 << z);
        negative_bits |= (bits_of(values) >> 31) & (1 << z);
        const Four counted = reinterpret_cast<Four>(bits_of(values) | ~near);  // no number where it is not near
        least = min(counted, least);
        most = max(counted, most);
      }
      for (std::size_t n = 0; n < 4; ++n) {
        found.active.words[x + n] |= static_cast<std::uint64_t>(near_bits[n]) << 8 * y;
        within.words[x + n] |= static_cast<std::uint64_t>(negative_bits[n] & ~near_bits[n]) << 8 * y;
      }
    }
  for (std::size_t x = 0; x < 8; ++x) {
    found.outside.words[x] = ~(found.active.words[x] | within.words[x]);
    found.any_inside = found.any_inside || within.words[x] != 0;
    found.any_outside = found.any_outside || found.outside.words[x] != 0;
  }
  found.least = std::min({least[0], least[1], least[2], least[3]});
  found.most = std::max({most[0], most[1], most[2], most[3]});
  return found;
}

void leaf_values(const DistanceField& field, const Tree::Leaf& leaf, float far, std::array<float, 512>& values) {
  std::array<float, 512> room;
  const float* const tile = tile_in_grid(field, leaf, room);
  for (std::size_t y = 0; y < 8; ++y)
    for (std::size_t z = 0; z < 8; z += 4)
      for (std::size_t x = 0; x < 8; x += 4) {
        std::array<Four, 4> rows;
        for (std::size_t n = 0; n < 4; ++n) {
          const Four row = load(tile + 64 * (z + n) + 8 * y + x);
          // Nothing in the band is as far, be the thickness infinite or not.
          rows[n] = reinterpret_cast<Four>(bits_of(min(magnitude(row), four(far))) | (bits_of(row) & ~kMagnitude));
        }
        transpose(rows);
        for (std::size_t n = 0; n < 4; ++n) std::memcpy(&values[64 * (x + n) + 8 * y + z], &rows[n], sizeof rows[n]);
      }
}

float background_of(const DistanceField& field) {
  const auto thickness = static_cast<float>(field.thickness());
  if (!std::isinf(thickness)) return thickness;
  float largest = 0;
  for (const float value : field.tile_values())
    if (!std::isinf(value)) largest = std::max(largest, std::abs(value));
  return largest > 0 ? largest : 1;
}

void check_indices(const DistanceField& field, const char* format) {
  const Size3& size = field.grid().size;
  constexpr std::int64_t kMost = std::int64_t{1} << 31;
  if (size.x > kMost || size.y > kMost || size.z > kMost)
    throw Error(ErrorCode::usage, std::string(".") + format +
                                      " has indices of 32 bits, and the grid has more samples on a side; use a "
                                      "coarser grid or another format");
}

}  // namespace standoff::vdb
