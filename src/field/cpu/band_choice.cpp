// SPDX-License-Identifier: Apache-2.0
#include "field/cpu/band_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "field/cpu/kernels.h"
#include "geometry/triangle_box.h"

namespace standoff::cpu {
namespace {

// Nanoseconds of one thread with AVX-512, fitted to five meshes and thicknesses of 1 to 12 spacings (docs/tiles.md).
// They decide time alone, and little of it where the two algorithms take about as long.
constexpr double kShortBlock = 5.2;    // to measure a block from a triangle in a brick's list
constexpr double kLongBlock = 10;      // the same for a long triangle, to find the block included
constexpr double kTriangleDown = 300;  // to put a triangle into the hierarchy
constexpr double kSampleDown = 8;      // to hand candidates down to a sample, and to measure them; and what is added,
constexpr double kDenserDown = 25;     // times the root of the number of triangles in a sample's area
constexpr double kAround = 4;          // spacings beyond the thickness in which cells are visited

// Triangles that are looked at, at most.
constexpr std::int64_t kMostLooks = 32768;

// The blocks along an axis that reach from `low` to `high`, wherever they begin. Lengths are in samples.
double blocks_along(double low, double high, std::int64_t size, int side) {
  const double reached = std::min(high, static_cast<double>(size - 1)) - std::max(low, 0.0);
  return reached < 0 ? 0 : reached / side + 1;
}

// What triangles are for the two algorithms. Lengths are in samples.
struct BandWork {
  double short_blocks = 0, long_blocks = 0, samples = 0, area = 0;

  void add(const std::array<Vec3, 3>& p, const Vec3& reach, const Size3& size) {
    const double thickness = std::min({reach.x, reach.y, reach.z});
    const Vec3 low = min(p[0], min(p[1], p[2])), high = max(p[0], max(p[1], p[2]));
    const Vec3 from = low - reach, to = high + reach;
    const double in_box = blocks_along(from.x, to.x, size.x, kBlockX) * blocks_along(from.y, to.y, size.y, kBlockY) *
                          blocks_along(from.z, to.z, size.z, kBlockZ);
    if (in_box == 0) return;
    const double of_triangle = length(cross(p[1] - p[0], p[2] - p[0])) / 2;
    if (max_norm(high - low) > kLongTriangle) {
      // Blocks within the thickness: the volume of the triangle, grown by that and by half a block's diagonal.
      const double grown = thickness + 1.7, around = length(p[1] - p[0]) + length(p[2] - p[1]) + length(p[0] - p[2]);
      const double volume = grown * (2 * of_triangle + std::numbers::pi * grown * (around / 2 + 4 * grown / 3));
      long_blocks += std::min(in_box, volume / kLanes);
    } else {
      short_blocks += in_box;
    }
    area += of_triangle;
    samples += std::min(kLanes * in_box, 2 * (thickness + kAround) * of_triangle);
  }
  double with_bins() const { return kShortBlock * short_blocks + kLongBlock * long_blocks; }
  double with_descent(double triangles) const {
    const double in_sample = area > 0 ? triangles / area : 0;
    return kTriangleDown * triangles + (kSampleDown + kDenserDown * std::sqrt(in_sample)) * samples;
  }
};

}  // namespace

BandAlgorithm band_algorithm(const Job& job) {
  if (!may_take_descent(job.grid, job.thickness)) return BandAlgorithm::bins;
  const Grid& grid = job.grid;
  const std::int64_t triangles = job.triangle_count(), looks = std::min(triangles, kMostLooks);
  if (!may_take_bins(triangles, grid, job.thickness)) return BandAlgorithm::descent;
  // Of a brick, bins gather all tiles, wanted or not.
  if (!job.wanted.empty()) return BandAlgorithm::descent;
  const Vec3 reach = Vec3{1, 1, 1} * job.thickness / grid.spacing;
  const Vec3 first{static_cast<double>(grid.first.x), static_cast<double>(grid.first.y),
                   static_cast<double>(grid.first.z)};
  BandWork work;
  for (std::int64_t n = 0; n < looks; ++n) {
    std::array<Vec3, 3> p = job.mesh.corners(job.triangle(triangles * n / looks));
    for (Vec3& at : p) at = (at - grid.origin) / grid.spacing - first;
    work.add(p, reach, grid.size);
  }
  return work.with_bins() <= work.with_descent(static_cast<double>(looks)) ? BandAlgorithm::bins
                                                                           : BandAlgorithm::descent;
}

}  // namespace standoff::cpu
