// SPDX-License-Identifier: Apache-2.0
#include "io/field/vdb_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "standoff/error.h"

namespace standoff::vdb {
namespace {

// Nodes of one level from those of the level below. A node that is inside throughout is none: `inside` says so.
enum class Made { nothing, node, inside };

class Builder {
 public:
  explicit Builder(const DistanceField& field)
      : field_(field), slots_(field.slots()), tiles_(field.tile_count()), far_(static_cast<float>(field.thickness())) {}

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

  // All of them by their first tile.
  Made upper(const Size3& first) {
    return node<kUpperLog>(first, kLowerSide / kLeafSide, tree_.uppers, tree_.lowers,
                           [this](const Size3& at, std::size_t) { return lower(at); });
  }
  Made lower(const Size3& first) {
    return node<kLowerLog>(first, 1, tree_.lowers, tree_.leaves, [this](const Size3& at, std::size_t) {
      const std::int32_t slot = slots_[static_cast<std::size_t>(at.x + tiles_.x * (at.y + tiles_.y * at.z))];
      if (slot < 0) return slot == DistanceField::kInside ? Made::inside : Made::nothing;
      const Made made = stored(at, slot);
      if (made == Made::node) tree_.leaves.push_back({{8 * at.x, 8 * at.y, 8 * at.z}, slot});
      return made;
    });
  }

  // A stored tile may have nothing in the band: one that is clamped throughout is no leaf.
  Made stored(const Size3& at, std::int32_t slot) const {
    const float* const tile =
        field_.tile_values().data() + std::size_t{DistanceField::kTileSamples} * static_cast<std::size_t>(slot);
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
  std::span<const std::int32_t> slots_;
  Size3 tiles_;
  float far_;
  Tree tree_;
};

}  // namespace

Tree tree_of(const DistanceField& field) { return Builder(field).build(); }

namespace {

// Eight flags, 0 or 1 each, as bits: the first one lowest.
std::uint64_t packed(const std::uint8_t* flags) {
  std::uint64_t bytes;
  std::memcpy(&bytes, flags, sizeof bytes);
  return bytes * 0x0102040810204080u >> 56;
}

// Bit k of byte n becomes bit n of byte k.
std::uint64_t transposed(std::uint64_t bits) {
  std::uint64_t swap = (bits ^ bits >> 7) & 0x00AA00AA00AA00AA;
  bits ^= swap ^ swap << 7;
  swap = (bits ^ bits >> 14) & 0x0000CCCC0000CCCC;
  bits ^= swap ^ swap << 14;
  swap = (bits ^ bits >> 28) & 0x00000000F0F0F0F0;
  return bits ^ swap ^ swap << 28;
}

// Flags of a tile's samples, x fastest, as the mask of a leaf, z fastest.
Mask<kLeafLog> mask_of(const std::array<std::uint8_t, 512>& flags) {
  Mask<kLeafLog> mask;
  for (std::size_t y = 0; y < 8; ++y) {
    std::uint64_t rows = 0;
    for (std::size_t z = 0; z < 8; ++z) rows |= packed(flags.data() + 8 * (y + 8 * z)) << 8 * z;
    rows = transposed(rows);
    for (std::size_t x = 0; x < 8; ++x) mask.words[x] |= (rows >> 8 * x & 0xFF) << 8 * y;
  }
  return mask;
}

}  // namespace

// Loops over all samples without a branch: for each of many leaves, and twice.
LeafValues leaf_values(const DistanceField& field, const Tree::Leaf& leaf, float far) {
  const Size3& size = field.grid().size;
  const float* const tile =
      field.tile_values().data() + std::size_t{DistanceField::kTileSamples} * static_cast<std::size_t>(leaf.slot);
  const auto thickness = static_cast<float>(field.thickness());
  std::array<std::uint8_t, 512> in_grid, near, inside;
  in_grid.fill(1);
  if (leaf.at.x + 8 > size.x || leaf.at.y + 8 > size.y || leaf.at.z + 8 > size.z)
    for (std::size_t n = 0; n < 512; ++n)
      in_grid[n] = leaf.at.x + static_cast<std::int64_t>(n & 7) < size.x &&
                   leaf.at.y + static_cast<std::int64_t>(n >> 3 & 7) < size.y &&
                   leaf.at.z + static_cast<std::int64_t>(n >> 6) < size.z;
  std::array<float, 512> clamped;
  for (std::size_t n = 0; n < 512; ++n) {
    const float value = tile[n];
    const bool is_near = std::abs(value) < thickness, negative = std::bit_cast<std::int32_t>(value) < 0;
    near[n] = static_cast<std::uint8_t>(is_near & in_grid[n]);
    inside[n] = static_cast<std::uint8_t>(!is_near & negative & in_grid[n]);
    clamped[n] = is_near ? value : std::copysign(far, value);
  }
  LeafValues found;
  found.active = mask_of(near);
  const Mask<kLeafLog> within = mask_of(inside);
  for (std::size_t x = 0; x < 8; ++x) {
    found.outside.words[x] = ~(found.active.words[x] | within.words[x]);
    found.any_inside = found.any_inside || within.words[x] != 0;
    found.any_outside = found.any_outside || found.outside.words[x] != 0;
  }
  for (std::size_t x = 0; x < 8; ++x)
    for (std::size_t y = 0; y < 8; ++y)
      for (std::size_t z = 0; z < 8; ++z) found.values[64 * x + 8 * y + z] = clamped[64 * z + 8 * y + x];
  // Tiles hold the thickness beyond the grid, but nothing keeps a caller from writing there.
  for (std::size_t n = 0; n < 512; ++n)
    if (in_grid[tile_sample(n)] == 0) found.values[n] = far;
  return found;
}

float background_of(const DistanceField& field) {
  const auto thickness = static_cast<float>(field.thickness());
  if (!std::isinf(thickness)) return thickness;
  float largest = 0;
  for (const float value : field.tile_values())
    if (!std::isinf(value)) largest = std::max(largest, std::abs(value));
  return largest > 0 ? largest : 1;
}

bool is_signed(const DistanceField& field) {
  if (!field.provenance().sign.empty()) return true;
  return std::ranges::find(field.slots(), DistanceField::kInside) != field.slots().end() ||
         std::ranges::any_of(field.tile_values(), [](float value) { return value < 0; });
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
