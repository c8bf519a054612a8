// SPDX-License-Identifier: Apache-2.0
// Algorithm 2 of the thesis (Fagerjord and Lochehina, 2008). It visits the samples of the field that has fewer.
#include <cmath>
#include <limits>

#include "core/guarded.h"
#include "core/tile_count.h"
#include "standoff/error.h"
#include "standoff/thesis.h"

namespace standoff {
namespace {

// Whether the boxes of two grids overlap in the world, on all three axes of the first grid's frame.
bool boxes_overlap(const DistanceField& a, const Pose& pose_a, const DistanceField& b, const Pose& pose_b) {
  const Box box = b.grid().bounds(), mine = a.grid().bounds();
  Box theirs;
  for (int corner = 0; corner < 8; ++corner)
    theirs.include(
        apply_inverse(pose_a, apply(pose_b, {corner & 1 ? box.min.x : box.max.x, corner & 2 ? box.min.y : box.max.y,
                                             corner & 4 ? box.min.z : box.max.z})));
  return theirs.min.x <= mine.max.x && mine.min.x <= theirs.max.x && theirs.min.y <= mine.max.y &&
         mine.min.y <= theirs.max.y && theirs.min.z <= mine.max.z && mine.min.z <= theirs.max.z;
}

// The nearest sample along an axis; -1 if it is not in the grid.
std::int64_t nearest_index(double at, double origin, double spacing, std::int64_t size) {
  const double index = std::floor((at - origin) / spacing + 0.5);
  return index >= 0 && index < static_cast<double>(size) ? static_cast<std::int64_t>(index) : -1;
}

// Calls use(sum) for each pair of samples that both have a value, until it returns false. Returns the number of samples
// visited.
template <class Use>
std::int64_t for_each_sum(const DistanceField& a, const Pose& pose_a, const DistanceField& b, const Pose& pose_b,
                          Use use) {
  if (a.grid().sample_count() < b.grid().sample_count()) return for_each_sum(b, pose_b, a, pose_a, use);
  if (!boxes_overlap(a, pose_a, b, pose_b)) return 0;
  const auto far_a = static_cast<float>(a.thickness()), far_b = static_cast<float>(b.thickness());
  const Grid &grid = a.grid(), &visited = b.grid();
  std::int64_t samples = 0;
  for (const DistanceField::Tile& tile : b.tiles())
    for (int n = 0; n < DistanceField::kTileSamples; ++n) {
      const std::int64_t i = tile.at.x * kTileSide + n % kTileSide,
                         j = tile.at.y * kTileSide + n / kTileSide % kTileSide,
                         k = tile.at.z * kTileSide + n / (kTileSide * kTileSide);
      if (i >= visited.size.x || j >= visited.size.y || k >= visited.size.z) continue;
      ++samples;
      const float value = tile.values[static_cast<std::size_t>(n)];
      if (!(std::abs(value) < far_b)) continue;
      const Vec3 p = apply_inverse(pose_a, apply(pose_b, visited.position(i, j, k)));
      const std::int64_t u = nearest_index(p.x, grid.origin.x, grid.spacing.x, grid.size.x),
                         v = nearest_index(p.y, grid.origin.y, grid.spacing.y, grid.size.y),
                         w = nearest_index(p.z, grid.origin.z, grid.spacing.z, grid.size.z);
      if (u < 0 || v < 0 || w < 0) continue;
      const float other = a.value(u, v, w);
      if (std::abs(other) < far_a && !use(double{value} + double{other})) return samples;
    }
  return samples;
}

}  // namespace

ThesisCollisionResult collide_thesis(const DistanceField& a, const Pose& pose_a, const DistanceField& b,
                                     const Pose& pose_b, double threshold) try {
  if (!(threshold > 0))
    throw Error(ErrorCode::usage, "collide: the threshold must be positive; thesis_sum() helps to choose it");
  validate(pose_a);
  validate(pose_b);
  ThesisCollisionResult result;
  result.samples = for_each_sum(a, pose_a, b, pose_b, [&](double sum) {
    result.hit = sum < threshold;
    return !result.hit;
  });
  return result;
} catch (...) {
  throw_as_error("collide");
}

double thesis_sum(const DistanceField& a, const Pose& pose_a, const DistanceField& b, const Pose& pose_b) try {
  validate(pose_a);
  validate(pose_b);
  double least = std::numeric_limits<double>::infinity();
  for_each_sum(a, pose_a, b, pose_b, [&](double sum) {
    least = std::min(least, sum);
    return true;
  });
  return least;
} catch (...) {
  throw_as_error("collide");
}

}  // namespace standoff
