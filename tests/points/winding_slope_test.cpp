// SPDX-License-Identifier: Apache-2.0
// The bound of the winding number's slope: beside differences of sums of solid angles, and the circle's closed form.
#include "points/winding_slope.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sign/diagnosis/boundary.h"
#include "sign/diagnosis/mesh_edges.h"
#include "tests/sign/shapes.h"
#include "tests/sign/solid_angles.h"
#include "tests/support/reference.h"

namespace standoff {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

Mesh disc(int corners) {
  Mesh mesh;
  mesh.vertices.push_back({0, 0, 0});
  for (int n = 0; n < corners; ++n) {
    const double angle = 2 * M_PI * n / corners;
    mesh.vertices.push_back({std::cos(angle), std::sin(angle), 0});
  }
  for (int n = 0; n < corners; ++n)
    mesh.triangles.push_back({0, static_cast<std::uint32_t>(1 + n), static_cast<std::uint32_t>(1 + (n + 1) % corners)});
  return mesh;
}

WindingSlope slope_of(const Mesh& mesh) { return WindingSlope(net_boundary({mesh}, MeshEdges(mesh))); }

TEST(WindingSlope, ClosedMeshHasNone) {
  EXPECT_EQ(slope_of(testing::box({0, 0, 0}, {1, 1, 1})).around({0.5, 0.5, 0.5}, 0.1, kAny), 0);
}

// On the axis of a circle of radius 1, at height z, the solid angle over 4 pi is (1 - z / sqrt(1 + z^2)) / 2.
TEST(WindingSlope, CircleOnItsAxis) {
  const WindingSlope slope = slope_of(disc(2000));
  for (const double z : {0.5, 1.0, 3.0, 40.0}) {
    const double exact = 0.5 / std::pow(1 + z * z, 1.5), bound = slope.around({0, 0, z}, 0, kAny);
    EXPECT_GE(bound, exact);
    // Turned lengths cancel by the angle under which the circle is seen; parts that are taken whole are a little
    // nearer.
    EXPECT_LE(bound, 0.5 / (1 + z * z) * 2.3) << z;
    EXPECT_GT(slope.around({0, 0, z}, z / 2, kAny), bound);
  }
}

TEST(WindingSlope, NothingIsSaidAtTheBoundaryOrAboveTheMost) {
  const WindingSlope slope = slope_of(disc(64));
  EXPECT_EQ(slope.around({1, 0, 0}, 0, kAny), kAny);
  EXPECT_EQ(slope.around({0, 0, 1}, 1.5, kAny), kAny);
  EXPECT_EQ(slope.around({0, 0, 1}, 0, 1e-3), kAny);
}

// The most of the bound that differences of solid angles between random points reach. The way may pass through a
// triangle, where the number jumps by a whole one.
double tightest(const Mesh& mesh, unsigned seed, double around, double step) {
  const WindingSlope slope = slope_of(mesh);
  testing::Random random(seed);
  double most = 0;
  for (int n = 0; n < 4000; ++n) {
    const Vec3 at = mesh.vertices[random.below(static_cast<std::uint32_t>(mesh.vertices.size()))];
    const Vec3 from = at + random.in_cube(around), to = from + random.in_cube(step);
    const double far = length(to - from), bound = slope.around(from, far, kAny) * far;
    if (!(bound < 0.5)) continue;
    const double difference = testing::winding_number(mesh, to) - testing::winding_number(mesh, from);
    most = std::max(most, std::abs(difference - std::round(difference)) / bound);
  }
  return most;
}

TEST(WindingSlope, BoundsDifferencesOfSolidAngles) {
  testing::Random random(3);
  Mesh soup;
  for (std::uint32_t n = 0; n < 60; ++n) {
    const Vec3 at = random.in_cube(1.0);
    for (int corner = 0; corner < 3; ++corner) soup.vertices.push_back(at + random.in_cube(0.2));
    soup.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  const std::pair<Mesh, double> of_edge = {disc(64), 0.4}, of_soup = {soup, 0.01};
  for (const auto& [mesh, least] : {of_edge, of_soup})
    for (const double around : {0.1, 1.0}) {
      const double most = tightest(mesh, 5, around, around / 20);
      EXPECT_LE(most, 1 + 1e-6);
      EXPECT_GT(most, least) << around;
    }
}

}  // namespace
}  // namespace standoff
