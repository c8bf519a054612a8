// SPDX-License-Identifier: Apache-2.0
#include "bvh/order.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <cstddef>
#include <limits>

#include "bvh/boxes16.h"
#include "core/memory.h"
#include "geometry/triangle_box.h"

namespace standoff {
namespace {

// Calls use(n, triangle, center) for the n-th triangle, the center in the cube [0, 1]^3 around all of them.
template <class Use>
void for_each_center(MeshView mesh, std::span<const std::uint32_t> among, ProgressMeter& progress, const Use& use) {
  using Blocked = tbb::blocked_range<std::size_t>;
  const Blocked all(0, among.empty() ? mesh.triangles.size() : among.size(), 4096);
  const auto triangle_at = [&](std::size_t n) { return among.empty() ? static_cast<std::uint32_t>(n) : among[n]; };
  const auto included = [&](const Blocked& range, Box box) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      const Box own = triangle_box(mesh, triangle_at(n));
      box = {min(box.min, own.min), max(box.max, own.max)};
    }
    return box;
  };
  const auto both = [](const Box& a, const Box& b) { return Box{min(a.min, b.min), max(a.max, b.max)}; };
  const Box box = tbb::parallel_reduce(all, Box{}, included, both);
  // A side that is zero, or too long or too short for a double, leaves all triangles in one place.
  const double longest = box.longest_side(), share = 1 / longest,
               scale = longest > 0 && std::isfinite(share) ? share : 0;
  tbb::parallel_for(all, [&](const Blocked& range) {
    progress.check();
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      const std::uint32_t triangle = triangle_at(n);
      const Vec3 at = scale > 0 ? (triangle_box(mesh, triangle).center() - box.min) * scale : Vec3{};
      use(n, triangle, min(at, Vec3{1, 1, 1}));
    }
  });
}

std::size_t longest_axis(std::span<const TriangleCenter> part) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::array<float, 3> low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
  for (const TriangleCenter& center : part)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], center.at[axis]);
      high[axis] = std::max(high[axis], center.at[axis]);
    }
  const auto side = [&](std::size_t axis) { return high[axis] - low[axis]; };
  const std::size_t of_xy = side(1) > side(0) ? 1 : 0;
  return side(2) > side(of_xy) ? 2 : of_xy;
}

// Triangles below which a part is not worth a task of its own.
constexpr std::size_t kHalvingTask = 8192;

// `node`: the most triangles of a node of the highest level of which the part may hold several. The order within a
// node of sixteen is of no use.
void halve(std::span<TriangleCenter> part, std::size_t node, ProgressMeter& progress) {
  constexpr std::size_t kFanout = Boxes16::kLanes;
  while (node >= part.size() && node >= kFanout) node /= kFanout;
  if (node < kFanout) return;
  const std::size_t nodes = (part.size() + node - 1) / node, middle = (nodes + 1) / 2 * node, axis = longest_axis(part);
  const auto before = [axis](const TriangleCenter& a, const TriangleCenter& b) {
    return a.at[axis] != b.at[axis] ? a.at[axis] < b.at[axis] : a.triangle < b.triangle;
  };
  std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(middle), part.end(), before);
  const auto left = [&] { halve(part.first(middle), node, progress); };
  const auto right = [&] { halve(part.subspan(middle), node, progress); };
  if (part.size() >= kHalvingTask) {
    progress.check();
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
}

// More triangles than this in one cell of a curve get a curve of their own, or nodes would hold triangles from all over
// the cell. The value is a choice: a uniform mesh has so many in a cell only if it has 10^9 triangles.
constexpr std::size_t kCrowdedCell = 1024;
// Curves in cells of curves. Each divides by 2^10, and no more than 2^60 spacings lie between triangles of a field.
constexpr int kMostCurves = 6;

std::vector<std::uint32_t> curve_order(MeshView mesh, std::span<const std::uint32_t> among, ProgressMeter& progress,
                                       int curves) {
  HugePageArray<KeyedIndex> keyed(among.empty() ? mesh.triangles.size() : among.size());
  for_each_center(mesh, among, progress, [&](std::size_t n, std::uint32_t triangle, const Vec3& at) {
    const auto cell = [](double v) { return static_cast<std::uint32_t>(v * 1023); };
    keyed[n] = {static_cast<std::uint32_t>(morton(cell(at.x), cell(at.y), cell(at.z))), triangle};
  });
  radix_sort(keyed, tbb::this_task_arena::max_concurrency());
  std::vector<std::uint32_t> order(keyed.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, order.size(), 65536), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) order[n] = keyed[n].index;
  });
  std::vector<std::span<std::uint32_t>> crowded;
  for (std::size_t first = 0; curves > 1 && first + kCrowdedCell < keyed.size();) {
    // The last of so many triangles is in another cell, unless the cell is crowded: then the rest is at hand.
    std::size_t end = first + kCrowdedCell;
    if (keyed[end].key != keyed[first].key) {
      while (keyed[end - 1].key == keyed[end].key) --end;
    } else {
      while (end < keyed.size() && keyed[end].key == keyed[first].key) ++end;
      if (end - first < keyed.size()) crowded.push_back(std::span(order).subspan(first, end - first));
    }
    first = end;
  }
  keyed = {};
  for (const std::span<std::uint32_t> cell : crowded)
    std::ranges::copy(curve_order(mesh, cell, progress, curves - 1), cell.begin());
  return order;
}

}  // namespace

std::vector<std::uint32_t> morton_order(MeshView mesh, std::span<const std::uint32_t> among, ProgressMeter& progress) {
  return curve_order(mesh, among, progress, kMostCurves);
}

std::vector<std::uint32_t> halving_order(std::span<TriangleCenter> centers, ProgressMeter& progress) {
  std::size_t node = 1;
  while (node < centers.size()) node *= Boxes16::kLanes;
  halve(centers, node, progress);
  std::vector<std::uint32_t> order(centers.size());
  std::ranges::transform(centers, order.begin(), &TriangleCenter::triangle);
  return order;
}

std::vector<std::uint32_t> halving_order(MeshView mesh, std::span<const std::uint32_t> among, ProgressMeter& progress) {
  std::vector<TriangleCenter> centers(among.empty() ? mesh.triangles.size() : among.size());
  for_each_center(mesh, among, progress, [&](std::size_t n, std::uint32_t triangle, const Vec3& at) {
    centers[n] = {{static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)}, triangle};
  });
  return halving_order(centers, progress);
}

}  // namespace standoff
