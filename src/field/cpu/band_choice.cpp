// SPDX-License-Identifier: Apache-2.0
#include "field/cpu/band_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

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
constexpr double kRegion = 60;         // to find the region of a triangle,
constexpr double kRegionBrick = 45;    // to set it up for a brick,
constexpr double kRegionClump = 8;     // to find its blocks among sixteen, and
constexpr double kRegionBlock = 5.5;   // to measure one of them

// Regions are looked for if they are guessed to save a tenth of the time: finding them takes up to that.
constexpr double kWorthFinding = 0.9;

// Triangles that are looked at, at most.
constexpr std::int64_t kMostLooks = 8192;

// The blocks along an axis that reach from `low` to `high`, wherever they begin. Lengths are in samples.
double blocks_along(double low, double high, std::int64_t size, int side) {
  const double reached = std::min(high, static_cast<double>(size - 1)) - std::max(low, 0.0);
  return reached < 0 ? 0 : reached / side + 1;
}

// The blocks within the thickness of a triangle: the volume of the triangle, grown by that and by half a block's
// diagonal.
double blocks_within(double area, double around, double thickness) {
  const double grown = thickness + 1.7;
  return grown * (2 * area + std::numbers::pi * grown * (around / 2 + 4 * grown / 3)) / kLanes;
}

// The blocks that meet a triangle's region: the volume of a prism that widens with the height, grown by most of a
// block.
double blocks_in_region(double area, double around, double thickness, double tilt) {
  const auto grown_area = [&](double height) {
    const double root = 1 + (1.4 + tilt * height) * around / (2 * area);
    return area * root * root;
  };
  const double height = thickness + 1;
  return height / 3 * (grown_area(0) + 4 * grown_area(height / 2) + grown_area(height)) / kLanes;
}

// What triangles are for the algorithms. Lengths are in samples.
struct BandWork {
  double short_blocks = 0, long_blocks = 0, samples = 0, area = 0;
  double region_bricks = 0, region_clumps = 0, region_blocks = 0;

  void add(const std::array<Vec3, 3>& p, const Vec3& reach, const Size3& size, const Region& region,
           const Vec3& units) {
    const double thickness = std::min({reach.x, reach.y, reach.z});
    const Vec3 low = min(p[0], min(p[1], p[2])), high = max(p[0], max(p[1], p[2]));
    // The cells of some size that the triangle's box, grown by a reach, touches.
    const auto touched = [&](const Vec3& by, int x, int y, int z) {
      return blocks_along(low.x - by.x, high.x + by.x, size.x, x) *
             blocks_along(low.y - by.y, high.y + by.y, size.y, y) *
             blocks_along(low.z - by.z, high.z + by.z, size.z, z);
    };
    const double in_box = touched(reach, kBlockX, kBlockY, kBlockZ);
    if (in_box == 0) return;
    const double of_triangle = length(cross(p[1] - p[0], p[2] - p[0])) / 2,
                 around = length(p[1] - p[0]) + length(p[2] - p[1]) + length(p[0] - p[2]),
                 near = std::min(in_box, blocks_within(of_triangle, around, thickness));
    if (max_norm(high - low) > kLongTriangle) {
      long_blocks += near;
    } else {
      short_blocks += in_box;
      const Vec3 reached = Vec3{region.reach[0], region.reach[1], region.reach[2]} / units;
      region_bricks += touched(reached, kBrickSide, kBrickSide, kBrickSide);
      region_clumps += touched(reached, 2 * kBlockX, 4 * kBlockY, 2 * kBlockZ);
      region_blocks +=
          region.tilt == kNoTilt ? near : std::min(near, blocks_in_region(of_triangle, around, thickness, region.tilt));
    }
    area += of_triangle;
    samples += std::min(kLanes * in_box, 2 * (thickness + kAround) * of_triangle);
  }
  double with_bins() const { return kShortBlock * short_blocks + kLongBlock * long_blocks; }
  double with_regions(double triangles) const {
    return kRegion * triangles + kRegionBrick * region_bricks + kRegionClump * region_clumps +
           kRegionBlock * region_blocks + kLongBlock * long_blocks;
  }
  double with_descent(double triangles) const {
    const double in_sample = area > 0 ? triangles / area : 0;
    return kTriangleDown * triangles + (kSampleDown + kDenserDown * std::sqrt(in_sample)) * samples;
  }
};

// The work of the triangles that are looked at, for the regions given.
template <class Of>
BandWork work_of(const Job& job, const Lattice& lattice, Of of) {
  const Grid& grid = job.grid;
  const std::int64_t triangles = job.triangle_count(), looks = std::min(triangles, kMostLooks);
  const Vec3 reach = Vec3{1, 1, 1} * job.thickness / grid.spacing;
  const Vec3 first{static_cast<double>(grid.first.x), static_cast<double>(grid.first.y),
                   static_cast<double>(grid.first.z)};
  BandWork work;
  for (std::int64_t n = 0; n < looks; ++n) {
    const std::int64_t at = triangles * n / looks;
    std::array<Vec3, 3> p = job.mesh.corners(job.triangle(at));
    for (Vec3& corner : p) corner = (corner - grid.origin) / grid.spacing - first;
    work.add(p, reach, grid.size, of(at), {lattice.unit[0], lattice.unit[1], lattice.unit[2]});
  }
  // Where sheets lie in each other's bands, the descent visits a sample once.
  const double share = triangles == 0 ? 0 : static_cast<double>(looks) / static_cast<double>(triangles);
  work.samples = std::min(work.samples, static_cast<double>(grid.sample_count()) * share);
  return work;
}

}  // namespace

BandChoice choose_band(const Job& job) {
  if (!may_take_descent(job.grid, job.thickness)) return {BandAlgorithm::bins, {}};
  const std::int64_t triangles = job.triangle_count();
  // Of a brick, bins gather all tiles, wanted or not.
  if (!may_take_bins(triangles, job.grid, job.thickness) || !job.wanted.empty()) return {BandAlgorithm::descent, {}};
  const Lattice lattice = make_lattice(job.grid, job.thickness);
  const auto looks = static_cast<double>(std::min(triangles, kMostLooks));
  const BandWork guessed = work_of(job, lattice, [&](std::int64_t n) { return guessed_region(job, lattice, n); });
  const double bins = guessed.with_bins(), descent = guessed.with_descent(looks), least = std::min(bins, descent);
  const BandAlgorithm without = bins <= descent ? BandAlgorithm::bins : BandAlgorithm::descent;
  if (guessed.with_regions(looks) >= kWorthFinding * least) return {without, {}};
  Regions regions = find_regions(job, lattice);
  if (regions.empty()) return {without, {}};
  const BandWork known = work_of(job, lattice, [&](std::int64_t n) { return regions[job.triangle(n)]; });
  if (known.with_regions(looks) >= least) return {without, {}};
  return {BandAlgorithm::bins, std::move(regions)};
}

}  // namespace standoff::cpu
