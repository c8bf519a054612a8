// SPDX-License-Identifier: Apache-2.0
// Builds the BVH of a body: the order of its triangles, and the spheres and oriented boxes of each level.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "bvh/order.h"
#include "collision/body/body.h"
#include "geometry/rounding.h"
#include "geometry/symmetric3.h"

namespace standoff::collision {
namespace {

// The factor that makes the radius of a bounding sphere an upper bound in spite of rounding in single precision:
// differences, squares, sums and a root, 2^-24 (6e-8) each. Smaller: corners stick out of their sphere, and
// intersecting bodies may count as free. Larger: more spheres are tested.
constexpr float kSphereRoundUp = 1 + 0x1p-21f;
static_assert(kSphereRoundUp - 1 > gamma_float(6));

// What a corner's coordinates along the axes lose in double precision, as a share of the largest one: a box's half
// extents are so much larger. Smaller: corners stick out, and a nearer pair of triangles may be missed. Larger: gaps
// that are small compared with the body are not seen.
constexpr double kObbError = 32 * kRoundoffDouble;
// The principal axes are taken if the box along the coordinate axes is larger than theirs by this factor: parts that
// are aligned anyway have the tighter box then, and flat ones are compared without rounding.
constexpr double kWorthTurning = 1.05;

// The numbers t_k with which p is the sum of t_k axis[k]. The axes are perpendicular only up to rounding.
struct Coordinates {
  Vec3 row[3];

  explicit Coordinates(const float (&axis)[3][3]) {
    const auto vec = [&](int k) { return Vec3{axis[k][0], axis[k][1], axis[k][2]}; };
    const double volume = dot(vec(0), cross(vec(1), vec(2)));
    for (int k = 0; k < 3; ++k) row[k] = cross(vec((k + 1) % 3), vec((k + 2) % 3)) * (1 / volume);
  }
};

struct Extents {
  double low[3] = {kInfinity, kInfinity, kInfinity}, high[3] = {-kInfinity, -kInfinity, -kInfinity};

  double side(int axis) const { return high[axis] - low[axis]; }
  // The smallest side times the largest face: how far the box reaches out of a patch, weighted by the patch.
  double measure() const {
    const double x = side(0), y = side(1), z = side(2);
    return std::min({x, y, z}) * std::max({x * y, x * z, y * z});
  }
};

Extents extents_along(std::span<const Vec3> points, const float (&axis)[3][3]) {
  const Coordinates coordinates(axis);
  Extents found;
  for (const Vec3& p : points)
    for (int k = 0; k < 3; ++k) {
      const double at = dot(coordinates.row[k], p);
      found.low[k] = std::min(found.low[k], at);
      found.high[k] = std::max(found.high[k], at);
    }
  return found;
}

// The eigenvectors of the covariance of the triangles' areas.
void principal_axes(std::span<const Vec3> corners, float (&axis)[3][3]) {
  double weight = 0, mean[3] = {}, square[3][3] = {};
  const Vec3 origin = corners[0];
  for (std::size_t n = 0; n < corners.size(); n += 3) {
    Vec3 c[4];
    for (std::size_t k = 0; k < 3; ++k) {
      c[k] = corners[n + k] - origin;
      c[3] = c[3] + c[k];
    }
    const double area = length(cross(c[1] - c[0], c[2] - c[0]));
    weight += area;
    // The integral of x_i x_j over a triangle: its corners' sum c[3] is thrice its centroid.
    for (int i = 0; i < 3; ++i) {
      mean[i] += area * c[3][i] / 3;
      for (int j = 0; j < 3; ++j)
        square[i][j] += area / 12 * (c[3][i] * c[3][j] + c[0][i] * c[0][j] + c[1][i] * c[1][j] + c[2][i] * c[2][j]);
    }
  }
  Matrix3 covariance{}, vectors{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      covariance[i][j] = weight > 0 ? square[i][j] / weight - mean[i] / weight * (mean[j] / weight) : 0;
  diagonalise(covariance, vectors);
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t j = 0; j < 3; ++j) axis[k][j] = static_cast<float>(vectors[j][k]);
}

Obb oriented_box(std::span<const Vec3> corners) {
  Obb box{{}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}};
  Extents extents = extents_along(corners, box.axis);
  float axis[3][3];
  principal_axes(corners, axis);
  if (const Extents turned = extents_along(corners, axis); extents.measure() > kWorthTurning * turned.measure()) {
    extents = turned;
    std::copy_n(&axis[0][0], 9, &box.axis[0][0]);
  }
  Vec3 rounded;
  for (int j = 0; j < 3; ++j) {
    double center = 0;
    for (int k = 0; k < 3; ++k) center += box.axis[k][j] * ((extents.low[k] + extents.high[k]) / 2);
    box.center[j] = static_cast<float>(center);
    rounded[j] = box.center[j];
  }
  // The box is about the rounded center and along the rounded axes, so that their rounding costs nothing.
  const Coordinates coordinates(box.axis);
  double largest = 0;
  for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(extents.low[k]), std::abs(extents.high[k])});
  for (int k = 0; k < 3; ++k) {
    const double center = dot(coordinates.row[k], rounded);
    const double half = std::max(extents.high[k] - center, center - extents.low[k]);
    box.half[k] = std::nextafter(static_cast<float>(half + kObbError * largest), kInfinity);
  }
  return box;
}

// The boxes of all nodes of a level, each of which holds `size` triangles.
HugePageVector<Obb16> oriented_boxes(std::span<const Vec3> corners, std::size_t size, std::size_t nodes) {
  HugePageVector<Obb16> boxes((nodes + kLanes - 1) / kLanes);
  tbb::parallel_for(std::size_t{0}, nodes, [&](std::size_t n) {
    const std::size_t first = 3 * size * n, count = std::min(3 * size, corners.size() - first);
    boxes[n / kLanes].set(static_cast<int>(n % kLanes), oriented_box(corners.subspan(first, count)));
  });
  return boxes;
}

}  // namespace

BodyBvh bvh_in_order(std::vector<std::uint32_t> order, MeshView mesh, Vec3 middle, ProgressMeter& progress) {
  const auto count = static_cast<std::int64_t>(order.size());
  std::vector<Vec3> corners(3 * order.size());
  tbb::parallel_for(std::int64_t{0}, count, [&](std::int64_t n) {
    for (int k = 0; k < 3; ++k) corners[3 * n + k] = mesh.corner(order[n], k) - middle;
  });
  progress.check();
  BodyBvh bvh;
  bvh.triangles.resize(static_cast<std::size_t>((count + kLanes - 1) / kLanes));
  tbb::parallel_for(std::int64_t{0}, static_cast<std::int64_t>(bvh.triangles.size()) * kLanes, [&](std::int64_t n) {
    const Vec3* const from = corners.data() + 3 * std::min(n, count - 1);
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis)
        bvh.triangles[n / kLanes].corner[k][axis][n % kLanes] = static_cast<float>(from[k][axis]);
  });
  // The boxes need not be grown: they hold the same float coordinates as the triangles.
  bvh.tree = Bvh(mesh, std::move(order), {middle}, progress);
  bvh.oriented.emplace_back();
  std::int64_t size = 1;  // the number of triangles of a child
  for (int level = 0; level <= bvh.top(); ++level, size *= kLanes) {
    progress.check();
    const std::span<const Boxes16> boxes = bvh.tree.level(level);
    HugePageVector<Sphere16>& spheres = bvh.spheres.emplace_back(boxes.size());
    tbb::parallel_for(std::int64_t{0}, static_cast<std::int64_t>(boxes.size()) * kLanes, [&](std::int64_t n) {
      Sphere16& sphere = spheres[n / kLanes];
      const int lane = static_cast<int>(n % kLanes);
      const Vec3* const begin = corners.data() + 3 * std::min(n * size, count);
      const Vec3* const end = corners.data() + 3 * std::min((n + 1) * size, count);
      const FloatBox box = lane_of(boxes[n / kLanes], lane);
      float center[3] = {};
      float radius = begin == end ? -kInfinity : 0;
      for (int axis = 0; axis < 3; ++axis) {
        if (begin != end) center[axis] = box.low[axis] + (box.high[axis] - box.low[axis]) / 2;
        sphere.center[axis][lane] = center[axis];
      }
      for (const Vec3* p = begin; p != end; ++p) {
        const float x = static_cast<float>(p->x) - center[0], y = static_cast<float>(p->y) - center[1],
                    z = static_cast<float>(p->z) - center[2];
        radius = std::max(radius, x * x + y * y + z * z);
      }
      sphere.radius[lane] = begin == end ? radius : std::sqrt(radius) * kSphereRoundUp;
    });
    bvh.oriented.push_back(oriented_boxes(corners, static_cast<std::size_t>(size) * kLanes, boxes.size()));
  }
  return bvh;
}

BodyBvh build_bvh(MeshView mesh, Vec3 middle, ProgressMeter& progress) {
  std::vector<TriangleCenter> centers(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, centers.size(), [&](std::size_t n) {
    const Vec3 a = mesh.corner(n, 0) - middle, b = mesh.corner(n, 1) - middle, c = mesh.corner(n, 2) - middle;
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] =
          std::minmax({static_cast<float>(a[axis]), static_cast<float>(b[axis]), static_cast<float>(c[axis])});
      centers[n].at[axis] = low + (high - low) / 2;
    }
    centers[n].triangle = static_cast<std::uint32_t>(n);
  });
  return bvh_in_order(halving_order(centers, progress), mesh, middle, progress);
}

}  // namespace standoff::collision
