// SPDX-License-Identifier: Apache-2.0
// Builds the BVH of a body: the order of its triangles, and the spheres and boxes of each level.
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>

#include "collision/body/model.h"
#include "geometry/rounding.h"

namespace standoff::collision {
namespace {

// A factor that carries the radius of a bounding sphere past its rounding in single precision: differences, squares,
// sums and a root, 2^-24 (6e-8) each. Smaller: corners stick out of their sphere, and intersecting bodies may count
// as free. Larger: more spheres are looked up.
constexpr float kSphereRoundUp = 1 + 0x1p-21f;
static_assert(kSphereRoundUp - 1 > gamma_float(6));

struct Item {
  float at[3];
  std::uint32_t triangle;
};

// Halves the range until it is one node of `capacity` triangles at the most, then goes on inside it. The order within
// a packet is of no use.
void arrange(Item* first, Item* last, std::int64_t capacity, ProgressMeter& progress) {
  const std::int64_t count = last - first;
  if (count <= kLanes) return;
  while (count <= capacity) capacity /= kLanes;
  const std::int64_t nodes = (count + capacity - 1) / capacity;
  FloatBox box;
  for (const Item* item = first; item != last; ++item) box.include(item->at);
  int axis = 0;
  for (int other = 1; other < 3; ++other)
    if (box.max[other] - box.min[other] > box.max[axis] - box.min[axis]) axis = other;
  Item* const middle = first + (nodes + 1) / 2 * capacity;
  const auto before = [axis](const Item& a, const Item& b) {
    return a.at[axis] != b.at[axis] ? a.at[axis] < b.at[axis] : a.triangle < b.triangle;
  };
  std::nth_element(first, middle, last, before);
  constexpr std::int64_t kWorthAThread = 4096;
  if (count > kWorthAThread) {
    progress.check();
    tbb::parallel_invoke([=, &progress] { arrange(first, middle, capacity, progress); },
                         [=, &progress] { arrange(middle, last, capacity, progress); });
  } else {
    arrange(first, middle, capacity, progress);
    arrange(middle, last, capacity, progress);
  }
}

struct FloatPoint {
  float x[3];
};

FloatPoint to_float(Vec3 corner, Vec3 middle) {
  const Vec3 c = corner - middle;
  return {{static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)}};
}

}  // namespace

void fill_levels(Bvh16& bvh, MeshView mesh, Vec3 middle, ProgressMeter& progress) {
  const auto count = static_cast<std::int64_t>(bvh.order.size());
  std::vector<FloatPoint> corners(3 * bvh.order.size());
  tbb::parallel_for(std::int64_t{0}, count, [&](std::int64_t n) {
    for (int k = 0; k < 3; ++k) corners[3 * n + k] = to_float(mesh.corner(bvh.order[n], k), middle);
  });
  progress.check();
  bvh.triangles.resize(static_cast<std::size_t>((count + kLanes - 1) / kLanes));
  tbb::parallel_for(std::int64_t{0}, static_cast<std::int64_t>(bvh.triangles.size()) * kLanes, [&](std::int64_t n) {
    const FloatPoint* const from = corners.data() + 3 * std::min(n, count - 1);
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) bvh.triangles[n / kLanes].corner[k][axis][n % kLanes] = from[k].x[axis];
  });
  bvh.levels.clear();
  for (std::int64_t size = 1;; size *= kLanes) {  // triangles of a node
    const std::int64_t nodes = (count + size - 1) / size, packets = (nodes + kLanes - 1) / kLanes;
    progress.check();
    BvhLevel level;
    level.spheres.resize(packets);
    level.boxes.resize(packets);
    tbb::parallel_for(std::int64_t{0}, packets * kLanes, [&](std::int64_t n) {
      Sphere16& spheres = level.spheres[n / kLanes];
      Aabb16& boxes = level.boxes[n / kLanes];
      const int lane = static_cast<int>(n % kLanes);
      const FloatPoint* const begin = corners.data() + 3 * std::min(n * size, count);
      const FloatPoint* const end = corners.data() + 3 * std::min((n + 1) * size, count);
      FloatBox box;
      for (const FloatPoint* p = begin; p != end; ++p) box.include(p->x);
      float center[3] = {};
      float radius = begin == end ? -kInfinity : 0;
      for (int axis = 0; axis < 3; ++axis) {
        boxes.min[axis][lane] = box.min[axis];
        boxes.max[axis][lane] = box.max[axis];
        if (begin != end) center[axis] = box.min[axis] + (box.max[axis] - box.min[axis]) / 2;
        spheres.center[axis][lane] = center[axis];
      }
      for (const FloatPoint* p = begin; p != end; ++p) {
        const float x = p->x[0] - center[0], y = p->x[1] - center[1], z = p->x[2] - center[2];
        radius = std::max(radius, x * x + y * y + z * z);
      }
      spheres.radius[lane] = begin == end ? radius : std::sqrt(radius) * kSphereRoundUp;
    });
    bvh.levels.push_back(std::move(level));
    if (packets == 1) return;
  }
}

Bvh16 build_bvh(MeshView mesh, Vec3 middle, ProgressMeter& progress) {
  std::vector<Item> items(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, items.size(), [&](std::size_t n) {
    const FloatPoint a = to_float(mesh.corner(n, 0), middle), b = to_float(mesh.corner(n, 1), middle),
                     c = to_float(mesh.corner(n, 2), middle);
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] = std::minmax({a.x[axis], b.x[axis], c.x[axis]});
      items[n].at[axis] = low + (high - low) / 2;
    }
    items[n].triangle = static_cast<std::uint32_t>(n);
  });
  std::int64_t capacity = 1;
  while (capacity < static_cast<std::int64_t>(items.size())) capacity *= kLanes;
  arrange(items.data(), items.data() + items.size(), capacity, progress);
  Bvh16 bvh;
  bvh.order.reserve(items.size());
  for (const Item& item : items) bvh.order.push_back(item.triangle);
  fill_levels(bvh, mesh, middle, progress);
  return bvh;
}

}  // namespace standoff::collision
