// SPDX-License-Identifier: Apache-2.0
// Hermite data of the surface of a mesh itself: where edges of the grid cross its triangles.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "sign/rows/ray_crossing.h"
#include "sign/rows/sample_axis.h"
#include "surface/cells.h"
#include "surface/each_block.h"
#include "surface/hermite.h"

namespace standoff {
namespace {

using Corners = std::array<Vec3, 3>;

// Coordinates turned in a circle, so that the first one is that of the axis (ray_crossing.h).
Vec3 turned(Vec3 v, int axis) { return axis == 0 ? v : axis == 1 ? Vec3{v.y, v.z, v.x} : Vec3{v.z, v.x, v.y}; }
// The turned axis that is y, along which samples are displaced most.
constexpr int most_displaced(int axis) { return axis == 0 ? 1 : axis == 1 ? 0 : 2; }

// The triangle that an edge takes is the one with the least key: of those that face as the sign changes, if there are
// any, the one nearest to where the interpolation crosses the edge; then the one of lowest index.
using Key = std::uint64_t;
constexpr Key kNone = std::numeric_limits<Key>::max();

// So near to a sample, in spacings, that rounding decides on which side of it the triangle is.
constexpr double kAtSample = 1e-5;

Key key_of(bool faces_otherwise, double distance, std::size_t triangle) {
  constexpr double kSteps = 0x1p30;
  const auto steps = static_cast<Key>(std::clamp(distance, 0.0, 1.0) * kSteps);
  return Key{faces_otherwise} << 63 | steps << 32 | static_cast<std::uint32_t>(triangle);
}

class Crossings {
 public:
  Crossings(const Blocks& blocks, MeshView mesh, std::span<const HermitePoint> guesses)
      : blocks_(blocks), grid_(blocks.field().grid()), mesh_(mesh), guesses_(guesses), keys_(guesses.size(), kNone) {}

  void find(std::size_t triangle) {
    const Corners corners = mesh_.corners(triangle);
    for (int axis = 0; axis < 3; ++axis) find_along(axis, corners, triangle);
  }
  /// The triangle of a crossed edge, or kNoTriangle.
  std::uint32_t triangle(std::uint32_t edge) const {
    return keys_[edge] == kNone ? kNoTriangle : static_cast<std::uint32_t>(keys_[edge]);
  }

 private:
  static constexpr double part(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
  SampleAxis samples(int axis) const {
    const Size3& n = grid_.size;
    return {part(grid_.origin, axis), part(grid_.spacing, axis), axis == 0 ? n.x : axis == 1 ? n.y : n.z};
  }

  void find_along(int axis, const Corners& corners, std::size_t triangle) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const SampleAxis along = samples(axis), rows = samples(u), layers = samples(v);
    Box box;
    for (const Vec3 corner : corners) box.include(corner);
    // One sample more on each side: rows are displaced by less than any number.
    const auto first = [](const SampleAxis& s, double low) { return std::max<std::int64_t>(0, s.first_from(low) - 1); };
    const std::int64_t begin_u = first(rows, part(box.min, u)), end_u = rows.first_from(part(box.max, u)) + 1;
    const std::int64_t begin_v = first(layers, part(box.min, v)), end_v = layers.first_from(part(box.max, v)) + 1;
    const RayTriangle ray({turned(corners[0], axis), turned(corners[1], axis), turned(corners[2], axis)},
                          most_displaced(axis));
    for (std::int64_t k = begin_v; k < std::min(end_v, layers.size()); ++k)
      for (std::int64_t j = begin_u; j < std::min(end_u, rows.size()); ++j) {
        const double y = rows.at(j), z = layers.at(k);
        const int crossing = ray.crossing(y, z);
        if (crossing == 0) continue;
        const double x = ray.crossing_x(y, z);
        const std::int64_t past = along.first(x, [&](std::int64_t n) {
          return ray.is_past({along.at(n), y, z}, crossing);
        });
        const double t = along.to_samples(x) - static_cast<double>(past - 1);
        offer(axis, j, k, past - 1, t, crossing, triangle);
        // At a sample: the value there may be 0, which is outside, whatever the exact side of the sample.
        if (t < kAtSample) offer(axis, j, k, past - 2, 1, crossing, triangle);
        if (t > 1 - kAtSample) offer(axis, j, k, past, 0, crossing, triangle);
      }
  }

  // Offers a triangle to the edge from sample i of row (j, k) along an axis to the next one.
  void offer(int axis, std::int64_t j, std::int64_t k, std::int64_t i, double t, int crossing, std::size_t triangle) {
    std::array<std::int64_t, 3> at{};
    at[static_cast<std::size_t>(axis)] = i;
    at[static_cast<std::size_t>((axis + 1) % 3)] = j;
    at[static_cast<std::size_t>((axis + 2) % 3)] = k;
    const Block* const block = blocks_.find(at[0] >> 3, at[1] >> 3, at[2] >> 3);
    if (!block) return;
    const int x = static_cast<int>(at[0] & 7), y = static_cast<int>(at[1] & 7), z = static_cast<int>(at[2] & 7);
    if ((block->edges[static_cast<std::size_t>(axis)][static_cast<std::size_t>(z)] >> (x + 8 * y) & 1) == 0) return;
    const std::uint32_t edge = block->vertex(axis, x, y, z);
    const bool leaves = part(guesses_[edge].normal(), axis) > 0;
    const Key key = key_of((crossing > 0) != leaves, std::isfinite(t) ? std::abs(t - guesses_[edge].t) : 1, triangle);
    const std::atomic_ref<Key> best(keys_[edge]);
    Key seen = best.load(std::memory_order_relaxed);
    while (key < seen && !best.compare_exchange_weak(seen, key, std::memory_order_relaxed)) {
    }
  }

  const Blocks& blocks_;
  Grid grid_;
  MeshView mesh_;
  std::span<const HermitePoint> guesses_;
  std::vector<Key> keys_;  // by edge
};

// Of a triangle that is as thin as can be too: scaled before it is multiplied.
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
  return {axis == 0 ? spacing.x : 0, axis == 1 ? spacing.y : 0, axis == 2 ? spacing.z : 0};
}

// Sets a point to where the plane of a triangle crosses an edge, with its normal to the side that the point's normal
// is on. False if it does not cross it.
bool on_plane(const Corners& corners, Vec3 lower, int axis, Vec3 spacing, HermitePoint& point) {
  const auto part = [&](Vec3 v) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; };
  const Vec3 normal = unit_normal(corners);
  if (part(normal) == 0) return false;
  const double t = dot(normal, corners[0] - lower) / (part(normal) * part(spacing));
  if (!(t > -kAtSample && t < 1 + kAtSample)) return false;
  const bool same_side = (part(normal) > 0) == (part(point.normal()) > 0);
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

// Where rounding is all that keeps a triangle off the edge, as where a face lies in a plane of samples: the triangle
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
                     std::span<HermitePoint> data, ProgressMeter& progress) {
  hermite_of_field(blocks, points, data, progress);
  Crossings crossings(blocks, mesh, data);
  constexpr std::size_t kAtOnce = 256;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), kAtOnce), [&](const auto& range) {
    progress.check();
    for (std::size_t n = range.begin(); n < range.end(); ++n) crossings.find(n);
  });
  const Grid& grid = blocks.field().grid();
  const auto lower_end = [&](const Block& block, int x, int y, int z) {
    return grid.origin + grid.spacing * Vec3{8.0 * block.at[0] + x, 8.0 * block.at[1] + y, 8.0 * block.at[2] + z};
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
  std::vector<Grazed> grazed;
  const Box box = grid.bounds().grown(0.5 * max_norm(grid.spacing));
  for (const Block& block : blocks.all()) {
    std::uint32_t edge = block.first_vertex;
    for_each_edge(block, [&](int axis, int x, int y, int z) {
      const Vec3 lower = lower_end(block, x, y, z), upper = lower + along(axis, grid.spacing);
      const bool within = max(lower, box.min) == lower && min(upper, box.max) == upper;
      if (crossings.triangle(edge) == kNoTriangle && within) grazed.push_back({edge, axis, lower});
      ++edge;
    });
  }
  if (!grazed.empty()) find_nearly(mesh, closest, grid.spacing, grazed, data);
}

}  // namespace standoff
