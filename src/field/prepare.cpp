// SPDX-License-Identifier: Apache-2.0
// The step before the backend: validates the mesh, checks memory and the range of float, applies the skip rule.
#include "field/prepare.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "core/tile_count.h"
#include "field/lattice.h"
#include "field/plan.h"
#include "field/skip.h"
#include "geometry/predicates.h"
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

// Which tiles of a grid the triangles of a mesh reach: what a sparse field may store, before it is computed.

constexpr std::int64_t kMostBlocks = std::int64_t{1} << 27;  // 16 MiB of bits
// The box of a triangle with more blocks than this holds many that are far from its plane. The value is a choice.
constexpr double kManyBlocks = 27;
// The error of a distance from a plane, relative to the coordinates: some ten operations in double precision, with
// room. Smaller: a tile may be missed, and a field takes more memory than was said.
constexpr double kPlaneRounding = 1e-12;

// Blocks of samples, of the same side along each axis, from `begin` to before `end`.
struct BlocksOfSamples {
  Size3 begin, end;

  // Those that hold some of the samples. Requires a range that is not empty.
  BlocksOfSamples(const SampleRange& samples, std::int64_t side) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      begin[axis] = samples.begin[axis] / side;
      end[axis] = (samples.end[axis] - 1) / side + 1;
    }
  }
  double count() const {
    return static_cast<double>(end.x - begin.x) * static_cast<double>(end.y - begin.y) *
           static_cast<double>(end.z - begin.z);
  }
};

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

// A bit for each tile. In grids of more than 2^27 tiles, and where the reach is more than 16 samples, a bit stands for
// several, all of which count as reached.
class ReachedTiles {
 public:
  // `reach`: the distance within which a triangle reaches samples, world units. The grid must outlive this.
  ReachedTiles(const Grid& grid, double reach) : grid_(grid), reach_(reach) {
    // No side is less than half of the reach, so that a small triangle reaches some 125 blocks however thick the band
    // is.
    const double most_samples = static_cast<double>(std::max({grid.size.x, grid.size.y, grid.size.z}));
    const double in_samples = reach / std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z});
    while (blocks().count() > kMostBlocks ||
           (2 * static_cast<double>(side_) < in_samples && static_cast<double>(side_) < most_samples))
      side_ *= 2;
    count_ = blocks();
    bits_.resize(static_cast<std::size_t>((count_.count() + 63) / 64));
  }

  // Marks the tiles that a triangle may reach. `samples`: those in its box grown by the reach, at least one. Threads
  // may call it at the same time.
  void mark(const Corners& corners, const SampleRange& samples) {
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

  // An upper bound of the number of tiles that are marked.
  double count() const {
    std::int64_t marked = 0;
    for (const std::uint64_t word : bits_) marked += std::popcount(word);
    const auto tiles_along_side = static_cast<double>(side_ / kTileSide);
    return static_cast<double>(marked) * tiles_along_side * tiles_along_side * tiles_along_side;
  }

 private:
  Size3 blocks() const {
    const auto along = [this](std::int64_t samples) { return (samples - 1) / side_ + 1; };
    return {along(grid_.size.x), along(grid_.size.y), along(grid_.size.z)};
  }
  void set(std::int64_t block) {
    const std::uint64_t bit = std::uint64_t{1} << (block % 64);
    const std::atomic_ref word(bits_[static_cast<std::size_t>(block / 64)]);
    if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
  }

  const Grid& grid_;
  double reach_;
  std::int64_t side_ = kTileSide;  // of a block
  Size3 count_;
  std::vector<std::uint64_t> bits_;
};

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
