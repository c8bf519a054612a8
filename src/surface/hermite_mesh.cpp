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

}  // namespace

void hermite_of_mesh(const Blocks& blocks, const EdgePoints& points, MeshView mesh, std::span<HermitePoint> data,
                     ProgressMeter& progress) {
  hermite_of_field(blocks, points, data, progress);
  Crossings crossings(blocks, mesh, data);
  constexpr std::size_t kAtOnce = 256;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), kAtOnce), [&](const auto& range) {
    progress.check();
    for (std::size_t n = range.begin(); n < range.end(); ++n) crossings.find(n);
  });
  const Grid& grid = blocks.field().grid();
  tbb::parallel_for(std::size_t{0}, blocks.all().size(), [&](std::size_t n) {
    const Block& block = blocks.all()[n];
    std::uint32_t edge = block.first_vertex;
    for_each_edge(block, [&](int axis, int x, int y, int z) {
      HermitePoint& point = data[edge];
      const std::uint32_t triangle = crossings.triangle(edge++);
      if (triangle == kNoTriangle) return;
      const Corners corners = mesh.corners(triangle);
      Vec3 normal = unit_normal(corners);
      const Vec3 lower =
          grid.origin + grid.spacing * Vec3{8.0 * block.at[0] + x, 8.0 * block.at[1] + y, 8.0 * block.at[2] + z};
      const auto part = [&](Vec3 v) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; };
      if (part(normal) == 0) return;
      const double t = dot(normal, corners[0] - lower) / (part(normal) * part(grid.spacing));
      if (!std::isfinite(t)) return;
      if ((part(normal) > 0) != (part(point.normal()) > 0)) normal = normal * -1.0;
      point.t = static_cast<float>(std::clamp(t, 0.0, 1.0));
      point.set_normal(normal);
    });
  });
}

}  // namespace standoff
