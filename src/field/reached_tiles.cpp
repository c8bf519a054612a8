// SPDX-License-Identifier: Apache-2.0
#include "field/reached_tiles.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

namespace standoff {
namespace {

constexpr std::int64_t kMostBlocks = std::int64_t{1} << 27;  // 16 MiB of bits
// The box of a triangle with more blocks than this holds many that are far from its plane. The value is a choice.
constexpr double kManyBlocks = 27;
// The error of a distance from a plane, relative to the coordinates: some ten operations in double precision, with
// room. Smaller: a tile may be missed, and a field takes more memory than was said.
constexpr double kPlaneRounding = 1e-12;

// Blocks that no sample of which is within reach of the triangle's plane can be left out.
class PlaneOfTriangle {
 public:
  PlaneOfTriangle(const Corners& corners, double reach, const Vec3& half)
      : corner_(corners[0]), normal_(cross(corners[1] - corners[0], corners[2] - corners[0])) {
    size_ = length(normal_);
    near_ = size_ * reach + std::abs(normal_.x) * half.x + std::abs(normal_.y) * half.y + std::abs(normal_.z) * half.z;
  }
  bool is_near(const Vec3& middle) const {
    const Vec3 from = middle - corner_;
    const double rounding = kPlaneRounding * size_ * (max_norm(middle) + max_norm(corner_));
    return !(std::abs(dot(normal_, from)) > near_ + rounding);
  }

 private:
  Vec3 corner_, normal_;
  double size_, near_;
};

}  // namespace

BlocksOfSamples::BlocksOfSamples(const SampleRange& samples, std::int64_t side) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    begin[axis] = samples.begin[axis] / side;
    end[axis] = (samples.end[axis] - 1) / side + 1;
  }
}

double BlocksOfSamples::count() const {
  return static_cast<double>(end.x - begin.x) * static_cast<double>(end.y - begin.y) *
         static_cast<double>(end.z - begin.z);
}

ReachedTiles::ReachedTiles(const Grid& grid, double reach) : grid_(grid), reach_(reach) {
  // No side is less than half of the reach, so that a small triangle reaches some 125 blocks however thick the band is.
  const double most_samples = static_cast<double>(std::max({grid.size.x, grid.size.y, grid.size.z}));
  const double in_samples = reach / std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  while (blocks().count() > kMostBlocks ||
         (2 * static_cast<double>(side_) < in_samples && static_cast<double>(side_) < most_samples))
    side_ *= 2;
  count_ = blocks();
  bits_.resize(static_cast<std::size_t>((count_.count() + 63) / 64));
}

Size3 ReachedTiles::blocks() const {
  const auto along = [this](std::int64_t samples) { return (samples - 1) / side_ + 1; };
  return {along(grid_.size.x), along(grid_.size.y), along(grid_.size.z)};
}

void ReachedTiles::mark(const Corners& corners, const SampleRange& samples) {
  const BlocksOfSamples range(samples, side_);
  const bool is_large = range.count() > kManyBlocks;
  const Vec3 half = grid_.spacing * (static_cast<double>(side_ - 1) / 2);
  const PlaneOfTriangle plane(corners, reach_, half);
  for (std::int64_t k = range.begin.z; k < range.end.z; ++k)
    for (std::int64_t j = range.begin.y; j < range.end.y; ++j)
      for (std::int64_t i = range.begin.x; i < range.end.x; ++i)
        if (!is_large || plane.is_near(grid_.position(i * side_, j * side_, k * side_) + half))
          set((k * count_.y + j) * count_.x + i);
}

void ReachedTiles::set(std::int64_t block) {
  const std::uint64_t bit = std::uint64_t{1} << (block % 64);
  const std::atomic_ref word(bits_[static_cast<std::size_t>(block / 64)]);
  if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
}

double ReachedTiles::count() const {
  std::int64_t marked = 0;
  for (const std::uint64_t word : bits_) marked += std::popcount(word);
  const auto tiles_along_side = static_cast<double>(side_ / kTileSide);
  return static_cast<double>(marked) * tiles_along_side * tiles_along_side * tiles_along_side;
}

}  // namespace standoff
