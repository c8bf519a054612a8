// SPDX-License-Identifier: Apache-2.0
#include "io/field/vdb_tree.h"

#include <algorithm>
#include <cmath>
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

LeafValues leaf_values(const DistanceField& field, const Tree::Leaf& leaf, float far) {
  const Size3& size = field.grid().size;
  const float* const tile =
      field.tile_values().data() + std::size_t{DistanceField::kTileSamples} * static_cast<std::size_t>(leaf.slot);
  const auto thickness = static_cast<float>(field.thickness());
  // Samples of the grid in each slice of x, a bit each.
  std::uint64_t in_slice = 0;
  for (std::size_t n = 0; n < 64; ++n)
    if (leaf.at.y + static_cast<std::int64_t>(n >> 3) < size.y && leaf.at.z + static_cast<std::int64_t>(n & 7) < size.z)
      in_slice |= std::uint64_t{1} << n;
  LeafValues found;
  for (std::size_t x = 0; x < 8; ++x) {
    const std::uint64_t in_grid = leaf.at.x + static_cast<std::int64_t>(x) < size.x ? in_slice : 0;
    float* const values = found.values.data() + 64 * x;
    std::uint64_t near = 0, negative = 0;
    for (std::size_t n = 0; n < 64; ++n) {
      const float value = tile[x + (n & 0x38) + 64 * (n & 7)];
      near |= std::uint64_t{std::abs(value) < thickness} << n;
      negative |= std::uint64_t{std::signbit(value)} << n;
      values[n] = value;
    }
    near &= in_grid;
    negative &= in_grid & ~near;
    found.active.words[x] = near;
    found.outside.words[x] = ~(near | negative);
    found.any_inside = found.any_inside || negative != 0;
    found.any_outside = found.any_outside || found.outside.words[x] != 0;
    for (std::size_t n = 0; n < 64; ++n)
      if (!(near >> n & 1)) values[n] = negative >> n & 1 ? -far : far;
  }
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
