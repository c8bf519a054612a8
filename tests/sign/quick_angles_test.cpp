// SPDX-License-Identifier: Apache-2.0
// Solid angles of many caps in float are within the error that they come with: far from caps, near them, in their
// planes and at their corners; for each instruction set the same.
#include "sign/open_winding/quick_angles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sign/diagnosis/mesh_edges.h"
#include "tests/sign/shapes.h"

namespace standoff {
namespace {

using namespace testing;

class Caps {
 public:
  explicit Caps(const Mesh& mesh)
      : rims_(net_boundary({mesh}, MeshEdges(mesh))), tree_(rims_), quick_(rims_, tree_, nobody_) {}

  // Returns the error.
  double expect_within_error(const Vec3& p, double tolerance) {
    WorkCheck unwatched(nobody_, kLooks);
    NodeStack stack(tree_, unwatched);
    const Interval exact = cap_sum_at(rims_, tree_, p, 0, stack);
    const auto found = quick_.at(p, tolerance, stack);
    if (!found) return -1;
    EXPECT_LE(std::abs(found->value - exact.value), found->error + exact.error)
        << p.x << ' ' << p.y << ' ' << p.z << ", tolerance " << tolerance;
    return found->error;
  }
  const Rims& rims() const { return rims_; }

 private:
  ProgressMeter nobody_;
  Rims rims_;
  RimTree tree_;
  QuickAngles quick_;
};

// Points of a triangle, of its edges, its corners and of their surroundings, at many distances.
template <class Use>
void for_each_point_near(const std::array<Vec3, 3>& t, Random& random, const Use& use) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const Vec3 places[] = {t[0], t[0] + (t[1] - t[0]) * 0.37, t[0] + (t[1] - t[0]) * 0.3 + (t[2] - t[0]) * 0.4,
                         t[0] + (t[1] - t[0]) * 1.2, t[0] + (t[2] - t[0]) * 0.5 - (t[1] - t[0]) * 0.1};
  for (const Vec3& place : places)
    for (double far = 1e-17; far < 2; far *= 10) {
      use(place + normal * (far / length(normal)));
      use(place - normal * (far / length(normal)));
      use(place + random.in_cube(far));
    }
}

TEST(QuickAngles, AreWithinTheirError) {
  Random random(1);
  Mesh holes = sphere(24);
  std::erase_if(holes.triangles, [&](const Triangle& t) { return (t[0] + t[1]) % 5 == 0; });
  Mesh weighted = random_soup(3, 60, 1, 0.3);
  for (int n = 0; n < 40; ++n) weighted.triangles.push_back(weighted.triangles[random.below(30)]);
  for (const Mesh& mesh :
       {random_soup(1, 400, 1, 0.2), random_soup(2, 60, 1, 1), random_soup(4, 300, 1e-7, 1, {5, 6, 7}),
        moved(random_soup(5, 300, 1, 0.01), {1e6, -2e6, 3e6}), holes, weighted, terrain()}) {
    Caps caps(mesh);
    const Box box = bounds(mesh);
    double largest = 0, sum = 0;
    int points = 0;
    for (const double tolerance : {1e-3, 1e-5, 0.0}) {
      for (int n = 0; n < 100; ++n) {
        const Vec3 p = box.center() + random.in_cube(1.2) * box.longest_side();
        const double error = caps.expect_within_error(p, tolerance);
        ASSERT_GE(error, 0);
        if (tolerance == 1e-3) continue;
        largest = std::max(largest, error);
        sum += error;
        ++points;
      }
      for (int n = 0; n < 5; ++n)
        for_each_point_near(MeshView(mesh).corners(random.below(static_cast<std::uint32_t>(mesh.triangles.size()))),
                            random, [&](const Vec3& p) { caps.expect_within_error(p, tolerance); });
    }
    EXPECT_LT(sum / points, 2e-3);  // and the error is worth something
    EXPECT_LT(largest, 0.05);
  }
}

TEST(QuickAngles, PointsTooFarHaveNone) {
  Caps caps(random_soup(1, 100, 1, 0.2));
  EXPECT_LT(caps.expect_within_error({1e7, 0, 0}, 1e-3), 0);
  EXPECT_GE(caps.expect_within_error({1e5, 0, 0}, 1e-3), 0);
}

TEST(QuickAngles, AreTheSameForAllInstructionSets) {
  const Mesh mesh = random_soup(6, 64, 1, 0.5);
  std::array<std::array<std::vector<float>, 3>, 3> corners;
  for (std::size_t t = 0; t < 64; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 v = mesh.vertices[mesh.triangles[t][k]];
      corners[k][0].push_back(static_cast<float>(v.x));
      corners[k][1].push_back(static_cast<float>(v.y));
      corners[k][2].push_back(static_cast<float>(v.z));
    }
  cpu::AngleTriangles triangles;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corners[k][axis].resize(64 + cpu::AngleTriangles::kLanes);
      triangles.corner[k][axis] = corners[k][axis].data();
    }
  Random random(7);
  for (int n = 0; n < 200; ++n) {
    const Vec3 at = random.in_cube(1);
    const float p[3] = {static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)};
    const auto found = [&](Simd simd) {
      cpu::AngleSums sums;
      std::ranges::fill(sums.re, 1.0f);
      std::ranges::fill(sums.im, 0.0f);
      std::ranges::fill(sums.around, 0.0f);
      cpu::AngleChunk chunk;
      cpu::sign_kernels_for(simd).add_solid_angles(triangles, 3, 50 + n % 11, p, 0.02f, sums, chunk);
      std::vector<float> all(sums.re, sums.re + 16);
      all.insert(all.end(), sums.im, sums.im + 16);
      all.insert(all.end(), sums.around, sums.around + 16);
      all.insert(all.end(), chunk.left, chunk.left + chunk.left_count);
      all.insert(all.end(), {chunk.least_length, chunk.least_sq});
      return all;
    };
    EXPECT_EQ(found(Simd::automatic), found(Simd::portable));
  }
}

}  // namespace
}  // namespace standoff
