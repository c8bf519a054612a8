// SPDX-License-Identifier: Apache-2.0
// Builds the BVH of a body: the order of its triangles, and the spheres of each level.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "bvh/order.h"
#include "collision/body/model.h"
#include "geometry/rounding.h"

namespace standoff::collision {
namespace {

// A factor that carries the radius of a bounding sphere past its rounding in single precision: differences, squares,
// sums and a root, 2^-24 (6e-8) each. Smaller: corners stick out of their sphere, and intersecting bodies may count
// as free. Larger: more spheres are looked up.
constexpr float kSphereRoundUp = 1 + 0x1p-21f;
static_assert(kSphereRoundUp - 1 > gamma_float(6));

struct FloatPoint {
  float x[3];
};

FloatPoint to_float(Vec3 corner, Vec3 middle) {
  const Vec3 c = corner - middle;
  return {{static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)}};
}

}  // namespace

BodyBvh bvh_in_order(std::vector<std::uint32_t> order, MeshView mesh, Vec3 middle, ProgressMeter& progress) {
  const auto count = static_cast<std::int64_t>(order.size());
  std::vector<FloatPoint> corners(3 * order.size());
  tbb::parallel_for(std::int64_t{0}, count, [&](std::int64_t n) {
    for (int k = 0; k < 3; ++k) corners[3 * n + k] = to_float(mesh.corner(order[n], k), middle);
  });
  progress.check();
  BodyBvh bvh;
  bvh.triangles.resize(static_cast<std::size_t>((count + kLanes - 1) / kLanes));
  tbb::parallel_for(std::int64_t{0}, static_cast<std::int64_t>(bvh.triangles.size()) * kLanes, [&](std::int64_t n) {
    const FloatPoint* const from = corners.data() + 3 * std::min(n, count - 1);
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) bvh.triangles[n / kLanes].corner[k][axis][n % kLanes] = from[k].x[axis];
  });
  // Boxes that are not grown: they hold the same float coordinates as the triangles.
  bvh.tree = Bvh(mesh, std::move(order), {middle}, progress);
  std::int64_t size = 1;  // the triangles of a child
  for (int level = 0; level <= bvh.top(); ++level, size *= kLanes) {
    progress.check();
    const std::span<const Boxes16> boxes = bvh.tree.level(level);
    HugePageVector<Sphere16>& spheres = bvh.spheres.emplace_back(boxes.size());
    tbb::parallel_for(std::int64_t{0}, static_cast<std::int64_t>(boxes.size()) * kLanes, [&](std::int64_t n) {
      Sphere16& sphere = spheres[n / kLanes];
      const int lane = static_cast<int>(n % kLanes);
      const FloatPoint* const begin = corners.data() + 3 * std::min(n * size, count);
      const FloatPoint* const end = corners.data() + 3 * std::min((n + 1) * size, count);
      const FloatBox box = lane_of(boxes[n / kLanes], lane);
      float center[3] = {};
      float radius = begin == end ? -kInfinity : 0;
      for (int axis = 0; axis < 3; ++axis) {
        if (begin != end) center[axis] = box.low[axis] + (box.high[axis] - box.low[axis]) / 2;
        sphere.center[axis][lane] = center[axis];
      }
      for (const FloatPoint* p = begin; p != end; ++p) {
        const float x = p->x[0] - center[0], y = p->x[1] - center[1], z = p->x[2] - center[2];
        radius = std::max(radius, x * x + y * y + z * z);
      }
      sphere.radius[lane] = begin == end ? radius : std::sqrt(radius) * kSphereRoundUp;
    });
  }
  return bvh;
}

BodyBvh build_bvh(MeshView mesh, Vec3 middle, ProgressMeter& progress) {
  std::vector<TriangleCenter> centers(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, centers.size(), [&](std::size_t n) {
    const FloatPoint a = to_float(mesh.corner(n, 0), middle), b = to_float(mesh.corner(n, 1), middle),
                     c = to_float(mesh.corner(n, 2), middle);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto [low, high] = std::minmax({a.x[axis], b.x[axis], c.x[axis]});
      centers[n].at[axis] = low + (high - low) / 2;
    }
    centers[n].triangle = static_cast<std::uint32_t>(n);
  });
  return bvh_in_order(halving_order(centers, progress), mesh, middle, progress);
}

}  // namespace standoff::collision
