// SPDX-License-Identifier: Apache-2.0
// The step before the backend: validates the mesh, checks memory and the range of float, applies the skip rule.
#include "field/prepare.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "field/lattice.h"
#include "field/plan.h"
#include "field/reached_tiles.h"
#include "field/skip.h"
#include "geometry/triangle_box.h"
#include "standoff/error.h"

namespace standoff {

namespace {

void check_spacing(const Grid& grid) {
  if (!is_moderate(grid.max_spacing()))
    throw Error(ErrorCode::limit, "compute: the spacing is " + std::to_string(std::ilogb(grid.max_spacing())) +
                                      " binary orders from one, too many for values in float; scale mesh and grid");
  if (!is_even(grid.spacing))
    throw Error(ErrorCode::limit,
                "compute: one spacing is less than 2^-60 of another, too little for float; take more even spacings");
}

constexpr const char* kTooFar =
    " is farther than 2^60 spacings, or 2^125 units, from the grid; remove it, scale the mesh or coarsen the grid";

}  // namespace

FloatRange::FloatRange(const Grid& grid)
    : center_(grid.bounds().center()), farthest_(std::min(0x1p60 * grid.max_spacing(), 0x1p125)) {}

void check_domain(MeshView mesh, const Grid& grid) {
  check_spacing(grid);
  const FloatRange near(grid);
  const auto is_far = [&](const tbb::blocked_range<std::size_t>& range, std::size_t first) {
    for (std::size_t t = range.begin(); t < range.end() && t < first; ++t)
      for (int k = 0; k < 3; ++k)
        if (!near.holds(mesh.corner(t, k))) return t;
    return first;
  };
  const std::size_t none = mesh.triangles.size();
  const std::size_t found = tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, none, 8192), none, is_far,
                                                 [](std::size_t a, std::size_t b) { return std::min(a, b); });
  if (found != none)
    throw Error(ErrorCode::limit, "mesh: triangle " + std::to_string(found) + kTooFar,
                {.triangle = static_cast<std::int64_t>(found)});
}

void check_domain(const Box& mesh, const Grid& grid) {
  check_spacing(grid);
  const FloatRange near(grid);
  if (!near.holds(mesh.min) || !near.holds(mesh.max))
    throw Error(ErrorCode::limit, std::string("mesh: a corner of its box") + kTooFar);
}

namespace {

using Positions = tbb::blocked_range<std::size_t>;
constexpr std::size_t kPrepareGrain = 16384;

// Vertices lie in a row, corners do not: this is several times faster than checking corners.
bool vertices_near(MeshView mesh, const FloatRange& range) {
  const auto look = [&](const Positions& positions, bool good) {
    for (std::size_t v = positions.begin(); v < positions.end(); ++v) good &= range.holds(mesh.vertices[v]);
    return good;
  };
  return tbb::parallel_reduce(Positions(0, mesh.vertices.size(), kPrepareGrain), true, look, std::logical_and<>());
}

// Whether a list of some triangles and the work on them fit into the memory planned for the work on all, whatever part
// of it are indices in bricks.
bool fits_with(std::size_t triangles, const Plan& plan) {
  const auto scratch = [&](std::int64_t count) {
    return plan.row->scratch_bytes({count}, plan.grid, plan.thickness, plan.threads);
  };
  const auto count = static_cast<std::int64_t>(triangles);
  return 2 * count <= plan.triangles &&
         static_cast<std::int64_t>(sizeof(std::uint32_t)) * count + scratch(count) <= scratch(plan.triangles);
}

// The most rows of samples along x that cross a triangle, which may lie beside the grid. They are points of a lattice
// in its projection: at most its area, half of its perimeter and one, in spacings (Nosarzewska 1948, for any convex
// set). `box`: the triangle's.
double rows_through(const Corners& triangle, Box box, const Grid& grid) {
  box.min.x = -std::numeric_limits<double>::infinity(), box.max.x = std::numeric_limits<double>::infinity();
  const SampleRange samples = samples_in(box, grid);
  if (samples.empty()) return 0;
  const double of_box =
      static_cast<double>(samples.end.y - samples.begin.y) * static_cast<double>(samples.end.z - samples.begin.z);
  std::array<Vec3, 3> sides;
  for (std::size_t n = 0; n < 3; ++n) {
    sides[n] = (triangle[(n + 1) % 3] - triangle[n]) / grid.spacing;
    sides[n].x = 0;
  }
  constexpr double kMoreThanRounding = 1 + 1e-9;
  const double perimeter = length(sides[0]) + length(sides[1]) + length(sides[2]),
               of_lattice = std::floor((length(cross(sides[0], sides[1])) + perimeter) / 2 * kMoreThanRounding + 1);
  return std::min(of_box, of_lattice);
}

}  // namespace

MeshScan scan_mesh(MeshView mesh, const Plan& plan, bool counts_tiles) {
  // If something is wrong, validate() finds and reports it.
  const bool counts_fit = !mesh.triangles.empty() && mesh.triangles.size() <= kMaxTriangles &&
                          mesh.vertices.size() <= std::numeric_limits<std::uint32_t>::max();
  const bool is_near = counts_fit && has_float_spacing(plan.grid) && vertices_near(mesh, FloatRange(plan.grid));
  if (!is_near) validate(mesh);

  const bool counts_boxes = counts_tiles && !std::isinf(plan.thickness);
  // A signed field also stores tiles with samples of both signs. The surface passes between two neighbouring samples,
  // and one of them is within half of their distance of it.
  const double least = plan.with_sign ? plan.grid.max_spacing() / 2 : 0;
  const double reach = reach_beyond_rounding(plan.grid, std::max(plan.thickness, least));
  const double touching = reach_beyond_rounding(plan.grid, 0);
  std::optional<ReachedTiles> tiles;
  if (counts_boxes) tiles.emplace(plan.grid, reach);
  // Sums of whole numbers are exact up to 2^53, in any order; a computation beyond that does not fit anyway.
  struct Sum {
    bool in_range;
    double brick_refs, crossings;
  };
  const auto look = [&](const Positions& positions, Sum sum) {
    bool in_range = true;
    for (std::size_t t = positions.begin(); t < positions.end(); ++t)
      for (const auto v : mesh.triangles[t]) in_range &= v < mesh.vertices.size();
    sum.in_range &= in_range;
    if (!counts_boxes || !in_range) return sum;
    for (std::size_t t = positions.begin(); t < positions.end(); ++t) {
      const auto box = triangle_box(mesh, t);
      if (plan.with_sign) sum.crossings += rows_through(mesh.corners(t), box.grown(touching), plan.grid);
      const SampleRange samples = samples_in(box.grown(reach), plan.grid);
      if (samples.empty()) continue;
      sum.brick_refs += BlocksOfSamples(samples, kBrickSide).count();
      tiles->mark(mesh.corners(t), samples);
    }
    return sum;
  };
  const auto both = [](const Sum& a, const Sum& b) {
    return Sum{a.in_range && b.in_range, a.brick_refs + b.brick_refs, a.crossings + b.crossings};
  };
  const Sum found =
      tbb::parallel_reduce(Positions(0, mesh.triangles.size(), kPrepareGrain), Sum{true, 0, 0}, look, both);
  if (!found.in_range) validate(mesh);
  MeshScan scan{.is_near = is_near};
  if (counts_boxes) scan.counts = {tiles->count(), found.brick_refs, found.crossings};
  return scan;
}

void check_mesh(MeshView mesh, const Plan& plan, const ComputeOptions& options) {
  // Most fields fit whatever their triangles are.
  const std::int64_t limit = memory_limit_of(options);
  const bool may_be_over = limit != 0 && bytes_needed(plan, options) > limit;
  const MeshScan scan = scan_mesh(mesh, plan, may_be_over);
  if (may_be_over) check_memory(mesh, plan, scan.counts, options);
  if (!scan.is_near) check_domain(mesh, plan.grid);
}

std::vector<std::uint32_t> kept_by_plan(MeshView mesh, const Plan& plan, std::span<const std::uint32_t> among,
                                        ProgressMeter& progress) {
  if (plan.rule.kind == SkipRule::Kind::none) {
    if (plan.drops_copies)
      if (std::vector<std::uint32_t> kept = without_many_copies(mesh, among, progress);
          !kept.empty() && fits_with(kept.size(), plan))
        return kept;
    return {among.begin(), among.end()};
  }
  if (!among.empty()) {
    std::vector<Triangle> triangles(among.size());
    std::ranges::transform(among, triangles.begin(), [&](std::uint32_t t) { return mesh.triangles[t]; });
    std::vector<std::uint32_t> kept = kept_by_plan({mesh.vertices, triangles}, plan, {}, progress);
    if (kept.empty()) return {among.begin(), among.end()};
    for (std::uint32_t& triangle : kept) triangle = among[triangle];
    return kept;
  }
  std::vector<std::uint32_t> kept = kept_triangles(mesh, plan.grid, plan.thickness, plan.rule);
  // To a Job an empty list means all triangles.
  if (kept.empty()) throw std::logic_error("the skip rule left no triangle");
  if (kept.size() == mesh.triangles.size()) kept.clear();
  return kept;
}

}  // namespace standoff
