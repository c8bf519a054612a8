// SPDX-License-Identifier: Apache-2.0
// The nearest triangle of each sample, from a field's tiles or from dense memory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>

#include "standoff/field.h"

namespace standoff {

/// A view. By default it has none.
class NearestTriangles {
 public:
  NearestTriangles() = default;
  explicit NearestTriangles(const DistanceField& field) : field_(field.has_nearest() ? &field : nullptr) {}
  /// One per sample, x fastest, or an empty span.
  NearestTriangles(const Grid& grid, std::span<const std::uint32_t> nearest) : size_(grid.size), dense_(nearest) {}

  /// Calls use(n, triangle) for each sample in a tile of the grid that has a nearest triangle; n is x + 8 y + 64 z.
  template <class Use>
  void for_each(std::int64_t tx, std::int64_t ty, std::int64_t tz, const Use& use) const {
    constexpr std::int64_t side = DistanceField::kTileSide;
    if (field_) {
      const auto tile = field_->tile_nearest(tx, ty, tz);
      for (std::size_t n = 0; tile && n < tile->size(); ++n)
        if ((*tile)[n] != kNoTriangle) use(n, (*tile)[n]);
      return;
    }
    if (dense_.empty()) return;
    for (std::int64_t z = 0; z < std::min(side, size_.z - side * tz); ++z)
      for (std::int64_t y = 0; y < std::min(side, size_.y - side * ty); ++y)
        for (std::int64_t x = 0; x < std::min(side, size_.x - side * tx); ++x) {
          const std::int64_t at = side * tx + x + size_.x * (side * ty + y + size_.y * (side * tz + z));
          const std::uint32_t triangle = dense_[static_cast<std::size_t>(at)];
          if (triangle != kNoTriangle) use(static_cast<std::size_t>(x + side * (y + side * z)), triangle);
        }
  }

 private:
  const DistanceField* field_ = nullptr;
  Size3 size_;
  std::span<const std::uint32_t> dense_;
};

}  // namespace standoff
