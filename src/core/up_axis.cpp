// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "core/guarded.h"
#include "standoff/mesh.h"

namespace standoff {
namespace {

constexpr std::array kAxes{Axis::z, Axis::y, Axis::x};  // in the order of preference
constexpr double kLow = 0.01;    // of a box's height: triangles that reach no higher are its base
constexpr double kLeast = 0.02;  // of the box's floor: a smaller base is a coincidence
constexpr double kMore = 1.25;   // by as much more another base is the flattest

double along(Axis axis, const Vec3& v) { return axis == Axis::x ? v.x : axis == Axis::y ? v.y : v.z; }

}  // namespace

Axis up_axis(MeshView mesh) try {
  const Box box = bounds(mesh);
  const double longest = box.longest_side();
  if (box.empty() || !(longest > 0 && std::isfinite(longest))) return Axis::z;
  // Sides of 1, or areas could be no doubles.
  const auto placed = [&](std::uint32_t v) { return (mesh.vertices[v] - box.min) / Vec3{longest, longest, longest}; };
  const Vec3 extent = box.extent() / Vec3{longest, longest, longest};
  std::array<double, 3> highest{}, base{};
  for (std::size_t n = 0; n < 3; ++n) highest[n] = kLow * along(kAxes[n], extent);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle triangle = mesh.triangles[t];
    const Vec3 a = placed(triangle[0]);
    for (std::size_t n = 0; n < 3; ++n) {
      const auto is_low = [&](const Vec3& v) { return along(kAxes[n], v) <= highest[n]; };
      if (!is_low(a)) continue;
      const Vec3 b = placed(triangle[1]), c = placed(triangle[2]);
      if (is_low(b) && is_low(c)) base[n] += std::abs(along(kAxes[n], cross(b - a, c - a))) / 2;
    }
  }
  std::size_t best = 0;
  double most = kLeast;
  for (std::size_t n = 0; n < 3; ++n) {
    const Axis axis = kAxes[n];
    const double floor =
        (axis == Axis::x ? 1 : extent.x) * (axis == Axis::y ? 1 : extent.y) * (axis == Axis::z ? 1 : extent.z);
    const double share = floor > 0 ? base[n] / floor : 0;
    if (share > most * (n > 0 && most > kLeast ? kMore : 1)) most = share, best = n;
  }
  return kAxes[best];
} catch (...) {
  throw_as_error("mesh");
}

}  // namespace standoff
