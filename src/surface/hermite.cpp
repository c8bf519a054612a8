// SPDX-License-Identifier: Apache-2.0
// Finds the points and normals of dual contouring on the crossed edges of the grid, from three sources: the field
// alone; the surface of a mesh, where its triangles cross the edges; and a surface at a distance from a mesh, by
// Newton's method along the edges, with exact distances.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/predicates.h"
#include "sign/flood/lattice.h"
#include "standoff/points.h"
#include "surface/cells.h"
#include "surface/methods.h"

namespace standoff {
namespace {

using Offset = std::array<int, 3>;

// The slope of the values along an axis at a sample, per spacing: a central difference if both neighbours are finite,
// else one-sided.
double slope(const Neighbourhood& values, const Offset& at, std::size_t axis) {
  Offset below = at, above = at;
  --below[axis];
  ++above[axis];
  const double here = values.value(at[0], at[1], at[2]);
  const double lower = values.value(below[0], below[1], below[2]), upper = values.value(above[0], above[1], above[2]);
  const bool has_lower = std::isfinite(lower), has_upper = std::isfinite(upper);
  if (has_lower && has_upper) return (upper - lower) / 2;
  if (!std::isfinite(here)) return 0;
  if (has_upper) return upper - here;
  return has_lower ? here - lower : 0;
}

}  // namespace

void hermite_of_field(const Blocks& blocks, const EdgePoints& points, std::span<HermitePoint> data,
                      ProgressMeter& progress) {
  const UniformTiles uniform(blocks.field().thickness());
  const Vec3 spacing = blocks.field().grid().spacing;
  const double unit = blocks.field().grid().max_spacing();
  for_each_block(blocks, uniform, progress,
                 [&](std::size_t, const Block& block, const CornerBits&, const Neighbourhood& values) {
                   HermitePoint* next = data.data() + block.first_vertex;
                   for_each_edge(block, [&](int axis, int x, int y, int z) {
                     const Offset lower{x, y, z};
                     Offset upper = lower;
                     ++upper[static_cast<std::size_t>(axis)];
                     const float a = values.value(x, y, z), b = values.value(upper[0], upper[1], upper[2]);
                     HermitePoint& point = *next++;
                     const double t = points.crossing(a, b);
                     point.t = static_cast<float>(t);
                     Vec3 along;
                     along[axis] = a < b ? 1 : -1;
                     const bool within = values.is_sample(x, y, z) && values.is_sample(upper[0], upper[1], upper[2]);
                     Vec3 normal = along;  // the normal of a cap
                     if (within) {
                       const auto mixed = [&](std::size_t n) {
                         const double s = n == static_cast<std::size_t>(axis)
                                              ? double{b} - a
                                              : slope(values, lower, n) * (1 - t) + slope(values, upper, n) * t;
                         return s;
                       };
                       const Vec3 gradient = Vec3{mixed(0), mixed(1), mixed(2)} / (spacing / Vec3{unit, unit, unit});
                       const double size = max_norm(gradient);
                       if (size > 0 && std::isfinite(size)) {
                         normal = gradient * (1 / size);
                         normal = normal * (1 / length(normal));
                       }
                     }
                     point.set_normal(normal);
                   });
                 });
}

namespace {

// Points of a query, and the approximate bytes of a point and its answer.
constexpr std::size_t kAskedAtOnce = std::size_t{1} << 17, kBytesPerAsked = 256;

// An edge takes the triangle with the least key. Triangles that face as the sign changes come first, then the triangle
// nearest to the crossing of the interpolation, then the lowest index.
using EdgeKey = std::uint64_t;
constexpr EdgeKey kNoEdge = std::numeric_limits<EdgeKey>::max();

// Nearer to a sample than this, in spacings, rounding decides on which side of it the triangle is.
constexpr double kAtSample = 1e-5;

EdgeKey key_of(bool faces_otherwise, double distance, std::size_t triangle) {
  constexpr double kSteps = 0x1p30;
  const auto steps = static_cast<EdgeKey>(std::clamp(distance, 0.0, 1.0) * kSteps);
  return EdgeKey{faces_otherwise} << 63 | steps << 32 | static_cast<std::uint32_t>(triangle);
}

class CrossingsOfEdges {
 public:
  CrossingsOfEdges(const Blocks& blocks, MeshView mesh, std::span<const HermitePoint> guesses)
      : blocks_(blocks),
        spacing_(blocks.field().grid().spacing),
        axes_(axes_of(blocks.field().grid())),
        mesh_(mesh),
        guesses_(guesses),
        keys_(guesses.size(), kNoEdge) {}

  void find(std::size_t triangle) {
    for_each_edge_hit(mesh_.corners(triangle), axes_, [&](std::size_t axis, auto sample, const EdgeHit& hit) {
      const double t = (hit.at - axes_[axis].at(sample[axis])) / spacing_[axis];
      for (std::int64_t& n : sample) n -= kMargin;
      offer(axis, sample, t, hit.crossing, triangle);
      // Very near a sample, offer the triangle to both edges: the value there may be 0, which counts as outside,
      // whatever the exact side of the sample.
      const std::int64_t at = sample[axis];
      if (t < kAtSample) {
        sample[axis] = at - 1;
        offer(axis, sample, 1, hit.crossing, triangle);
      }
      if (t > 1 - kAtSample) {
        sample[axis] = at + 1;
        offer(axis, sample, 0, hit.crossing, triangle);
      }
    });
  }
  /// The triangle of a crossed edge, or kNoTriangle.
  std::uint32_t triangle(std::uint32_t edge) const {
    return keys_[edge] == kNoEdge ? kNoTriangle : static_cast<std::uint32_t>(keys_[edge]);
  }

 private:
  // Edges lead from the grid's outermost samples to samples beside the grid, which are all outside (blocks.h); a
  // triangle near such a sample may even be beyond it.
  static constexpr std::int64_t kMargin = 2;
  static std::array<LatticeAxis, 3> axes_of(const Grid& grid) {
    const LatticeAxis::Margin margin{kMargin, kMargin};
    return {LatticeAxis(axis_of(grid, 0), margin), LatticeAxis(axis_of(grid, 1), margin),
            LatticeAxis(axis_of(grid, 2), margin)};
  }

  // Offers a triangle to the edge from a sample along an axis to the next one.
  void offer(std::size_t axis, const std::array<std::int64_t, 3>& at, double t, int crossing, std::size_t triangle) {
    const Block* const block = blocks_.find(at[0] >> 3, at[1] >> 3, at[2] >> 3);
    if (!block) return;
    const int x = static_cast<int>(at[0] & 7), y = static_cast<int>(at[1] & 7), z = static_cast<int>(at[2] & 7);
    if ((block->edges[axis][static_cast<std::size_t>(z)] >> (x + 8 * y) & 1) == 0) return;
    const std::uint32_t edge = block->vertex(static_cast<int>(axis), x, y, z);
    const bool leaves = guesses_[edge].normal()[axis] > 0;
    const EdgeKey key =
        key_of((crossing > 0) != leaves, std::isfinite(t) ? std::abs(t - guesses_[edge].t) : 1, triangle);
    const std::atomic_ref<EdgeKey> best(keys_[edge]);
    EdgeKey seen = best.load(std::memory_order_relaxed);
    while (key < seen && !best.compare_exchange_weak(seen, key, std::memory_order_relaxed)) {
    }
  }

  const Blocks& blocks_;
  Vec3 spacing_;
  std::array<LatticeAxis, 3> axes_;
  MeshView mesh_;
  std::span<const HermitePoint> guesses_;
  std::vector<EdgeKey> keys_;  // by edge
};

// The unit normal, even of extremely thin triangles: edges are scaled before they are multiplied.
Vec3 unit_normal(const Corners& corners) {
  Vec3 a = corners[1] - corners[0], b = corners[2] - corners[0];
  const double size = std::max(max_norm(a), max_norm(b));
  if (!(size > 0)) return {};
  const Vec3 n = cross(a * (1 / size), b * (1 / size));
  const double longest = max_norm(n);
  if (!(longest > 0)) return {};
  const Vec3 scaled = n * (1 / longest);
  return scaled * (1 / length(scaled));
}

Vec3 along(int axis, Vec3 spacing) {
  Vec3 step;
  step[axis] = spacing[axis];
  return step;
}

// Moves a point to the crossing of a triangle's plane and an edge, with the plane's normal on the side of the point's
// old normal. False if there is no crossing.
bool on_plane(const Corners& corners, Vec3 lower, int axis, Vec3 spacing, HermitePoint& point) {
  const Vec3 normal = unit_normal(corners);
  if (normal[axis] == 0) return false;
  const double t = dot(normal, corners[0] - lower) / (normal[axis] * spacing[axis]);
  if (!(t > -kAtSample && t < 1 + kAtSample)) return false;
  const bool same_side = (normal[axis] > 0) == (point.normal()[axis] > 0);
  point.t = static_cast<float>(std::clamp(t, 0.0, 1.0));
  point.set_normal(same_side ? normal : normal * -1.0);
  return true;
}

// A crossed edge with no triangle on it, whose ends are samples.
struct Grazed {
  std::uint32_t edge;
  int axis;
  Vec3 lower;
};

// Finds triangles that only rounding keeps off an edge, as if a face lies in a plane of samples: takes the triangle
// nearest to the end that is farther from the surface, if its plane crosses the edge on the mesh.
void find_nearly(MeshView mesh, const ClosestFunction& closest, const Vec3& spacing, std::span<const Grazed> grazed,
                 std::span<HermitePoint> data) {
  std::vector<Vec3> ends, crossings;
  for (const Grazed& edge : grazed)
    ends.push_back(edge.lower + (data[edge.edge].t > 0.5f ? Vec3{} : along(edge.axis, spacing)));
  const std::vector<ClosestPoint> nearest = closest(ends);
  std::vector<HermitePoint> found(grazed.size());
  for (std::size_t n = 0; n < grazed.size(); ++n) {
    const Grazed& edge = grazed[n];
    found[n] = data[edge.edge];
    if (!on_plane(mesh.corners(nearest[n].triangle), edge.lower, edge.axis, spacing, found[n])) found[n].t = -1;
    crossings.push_back(edge.lower + along(edge.axis, spacing) * static_cast<double>(found[n].t));
  }
  const std::vector<ClosestPoint> at_crossing = closest(crossings);
  for (std::size_t n = 0; n < grazed.size(); ++n)
    if (found[n].t >= 0 && at_crossing[n].distance <= kAtSample * max_norm(along(grazed[n].axis, spacing)))
      data[grazed[n].edge] = found[n];
}

}  // namespace

void hermite_of_mesh(const Blocks& blocks, const EdgePoints& points, MeshView mesh, const ClosestFunction& closest,
                     std::span<HermitePoint> data, MemoryBudget& budget, ProgressMeter& progress) {
  hermite_of_field(blocks, points, data, progress);
  MemoryShare memory(budget);
  memory.take(data.size() * sizeof(EdgeKey));
  CrossingsOfEdges crossings(blocks, mesh, data);
  constexpr std::size_t kAtOnce = 256;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), kAtOnce), [&](const auto& range) {
    progress.check();
    for (std::size_t n = range.begin(); n < range.end(); ++n) crossings.find(n);
  });
  const Grid& grid = blocks.field().grid();
  const auto lower_end = [&](const Block& block, int x, int y, int z) {
    return grid.position(8 * block.at[0] + x, 8 * block.at[1] + y, 8 * block.at[2] + z);
  };
  tbb::parallel_for(std::size_t{0}, blocks.all().size(), [&](std::size_t n) {
    const Block& block = blocks.all()[n];
    std::uint32_t edge = block.first_vertex;
    for_each_edge(block, [&](int axis, int x, int y, int z) {
      const std::uint32_t triangle = crossings.triangle(edge);
      if (triangle != kNoTriangle)
        on_plane(mesh.corners(triangle), lower_end(block, x, y, z), axis, grid.spacing, data[edge]);
      ++edge;
    });
  });
  const std::size_t at_once = std::min(data.size(), kAskedAtOnce);
  memory.take(at_once * (sizeof(Grazed) + kBytesPerAsked));
  std::vector<Grazed> grazed;
  grazed.reserve(at_once);
  const auto flush = [&] {
    progress.check();
    if (!grazed.empty()) find_nearly(mesh, closest, grid.spacing, grazed, data);
    grazed.clear();
  };
  const Box box = grid.bounds().grown(0.5 * max_norm(grid.spacing));
  for (const Block& block : blocks.all()) {
    std::uint32_t edge = block.first_vertex;
    for_each_edge(block, [&](int axis, int x, int y, int z) {
      const Vec3 lower = lower_end(block, x, y, z), upper = lower + along(axis, grid.spacing);
      const bool within = max(lower, box.min) == lower && min(upper, box.max) == upper;
      if (crossings.triangle(edge) == kNoTriangle && within) grazed.push_back({edge, axis, lower});
      if (grazed.size() == at_once) flush();
      ++edge;
    });
  }
  flush();
}

namespace {

// An edge of the grid whose ends are samples.
struct OffsetSearch {
  std::uint32_t edge;
  Vec3 lower, step;  // the lower end, and the vector to the upper end
  double t;
  double low = 0, high = 1;  // the crossing lies between them
};

constexpr int kMostRounds = 30;       // three are enough for most
constexpr double kNearEnough = 1e-7;  // spacings: the resolution of t as a float

// Finds the points of all searches, and empties `searches`.
void find_points(std::vector<OffsetSearch>& searches, const MeshOffset& offset, std::span<HermitePoint> data,
                 ProgressMeter& progress) {
  std::vector<Vec3> asked;
  for (int round = 0; round < kMostRounds && !searches.empty(); ++round) {
    progress.check();
    asked.clear();
    for (const OffsetSearch& search : searches) asked.push_back(search.lower + search.step * search.t);
    const std::vector<ClosestPoint> found = offset.closest(asked);
    std::size_t left = 0;
    for (std::size_t n = 0; n < searches.size(); ++n) {
      OffsetSearch search = searches[n];
      const ClosestPoint& nearest = found[n];
      const double edge = max_norm(search.step), miss = nearest.distance - offset.distance;
      if (!(nearest.distance > 0)) continue;  // on the mesh there is no direction
      // The gradient of the value, and its part along the edge, per edge.
      const Vec3 away = (asked[n] - nearest.point) * (1 / nearest.distance);
      const double slope = dot(away, search.step);
      const Vec3 outwards = offset.inside ? away * -1.0 : away;
      // The value must grow from the end inside to the end outside.
      const double grows = dot(outwards, search.step), expected = dot(data[search.edge].normal(), search.step);
      if (std::abs(miss) <= kNearEnough * edge) {
        if (grows * expected <= 0) continue;  // the point is on another surface
        data[search.edge].t = static_cast<float>(search.t);
        data[search.edge].set_normal(outwards);
        continue;
      }
      // Take Newton's step, or half of the interval if it leads out: past a ridge another triangle is the closest one.
      const bool is_inside = (miss > 0) == offset.inside, rises = expected > 0;
      (is_inside == rises ? search.low : search.high) = search.t;
      double next = search.t - miss / slope;
      if (!(next > search.low && next < search.high)) next = (search.low + search.high) / 2;
      if (next == search.t) continue;
      search.t = next;
      searches[left++] = search;
    }
    searches.resize(left);
  }
  searches.clear();  // the interpolation stays where no point was found
}

}  // namespace

void hermite_of_offset(const Blocks& blocks, const EdgePoints& points, const MeshOffset& offset,
                       std::span<HermitePoint> data, MemoryBudget& budget, ProgressMeter& progress) {
  hermite_of_field(blocks, points, data, progress);
  MemoryShare memory(budget);
  const std::size_t at_once = std::min(data.size(), kAskedAtOnce);
  memory.take(at_once * (sizeof(OffsetSearch) + kBytesPerAsked));
  std::vector<OffsetSearch> searches;
  searches.reserve(at_once);
  const Grid& grid = blocks.field().grid();
  const Size3& size = grid.size;
  for (const Block& block : blocks.all()) {
    std::uint32_t edge = block.first_vertex;
    for_each_edge(block, [&](int axis, int x, int y, int z) {
      const std::int64_t i = 8 * std::int64_t{block.at[0]} + x, j = 8 * std::int64_t{block.at[1]} + y,
                         k = 8 * std::int64_t{block.at[2]} + z;
      const std::uint32_t n = edge++;
      if (i < 0 || j < 0 || k < 0 || i + (axis == 0) >= size.x || j + (axis == 1) >= size.y ||
          k + (axis == 2) >= size.z)
        return;
      Vec3 step;
      step[axis] = grid.spacing[axis];
      searches.push_back({n, grid.position(i, j, k), step, data[n].t});
      if (searches.size() == at_once) find_points(searches, offset, data, progress);
    });
  }
  find_points(searches, offset, data, progress);
}

}  // namespace standoff
