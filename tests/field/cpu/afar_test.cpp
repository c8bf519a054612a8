// SPDX-License-Identifier: Apache-2.0
// Meshes that are small compared with a sample's distance, where rounding makes many triangles the nearest: the bits
// and the nearest triangles must be those of measuring all triangles from every sample.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "field/lattice.h"
#include "tests/support/changed_mesh.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"
#include "tests/support/welded_ball.h"

namespace standoff::testing {
namespace {

// A triangle as the samples of one brick measure it.
class Measured {
 public:
  Measured(const Lattice& lattice, const Triple<double>& center, const std::array<Vec3, 3>& corners) {
    Triple<double> exact[3];
    Triple<float> corner[3];
    for (int n = 0; n < 3; ++n) {
      exact[n] = local(lattice, {corners[n].x, corners[n].y, corners[n].z}, center);
      corner[n] = narrowed(exact[n]);
    }
    if (const BoxOf<float> box = box_of(corner[0], corner[1], corner[2]); is_speck(lattice, box))
      for (Triple<float>& one : corner) one = middle_of(box);
    frame_ = make_frame(corner[0], corner[1], corner[2], kLeastLengthSq);
    is_long_ = is_long(box_of(corner[0], corner[1], corner[2]));
    if (is_long_) lines_ = make_lines<float>(make_frame(exact[0], exact[1], exact[2], double{kLeastLengthSq}));
  }
  float from(const Triple<float>& sample) const {
    return is_long_ ? distance_sq(lines_, sample) : distance_sq(frame_, sample);
  }

 private:
  TriangleFrame<float> frame_;
  TriangleLines<float> lines_;
  bool is_long_;
};

// Compares samples step, 2 step, ... along each axis of a full field with all triangles.
void expect_bits_of_all(const Mesh& mesh, const Grid& grid, int step, const std::string& name) {
  const Lattice lattice = make_lattice(grid, kInfinity);
  std::int64_t compared = 0, wrong_values = 0, wrong_nearest = 0;
  const DistanceField field = computed(mesh, grid, kInfinity).field;
  for (std::int64_t bz = 0; bz * kBrickSide < grid.size.z; ++bz)
    for (std::int64_t by = 0; by * kBrickSide < grid.size.y; ++by)
      for (std::int64_t bx = 0; bx * kBrickSide < grid.size.x; ++bx) {
        const Triple<double> center = cell_center<kBrickSide>(lattice, bx, by, bz);
        std::vector<Measured> all;
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
          all.emplace_back(lattice, center, MeshView(mesh).corners(t));
        for (int n = 0; n < kBrickSide * kBrickSide * kBrickSide; n += step) {
          const int x = n % kBrickSide, y = n / kBrickSide % kBrickSide, z = n / (kBrickSide * kBrickSide);
          const std::int64_t i = bx * kBrickSide + x, j = by * kBrickSide + y, k = bz * kBrickSide + z;
          if (i >= grid.size.x || j >= grid.size.y || k >= grid.size.z) continue;
          const Triple<float> sample{lattice.coordinate[0][x], lattice.coordinate[1][y], lattice.coordinate[2][z]};
          float best = std::numeric_limits<float>::infinity();
          std::uint32_t nearest = kNoTriangle;
          for (std::uint32_t t = 0; t < all.size(); ++t)
            if (const float d = all[t].from(sample); d < best) best = d, nearest = t;
          ++compared;
          wrong_values += field.value(i, j, k) != std::sqrt(best) * lattice.unscale;
          wrong_nearest += field.nearest(i, j, k) != nearest;
        }
      }
  EXPECT_EQ(wrong_values, 0) << name;
  EXPECT_EQ(wrong_nearest, 0) << name;
  EXPECT_GT(compared, 100) << name;
}

// A ball of small triangles around `center`, and how far they are from its middle.
void add_ball(Mesh& mesh, unsigned seed, int triangles, const Vec3& center, double radius) {
  Random random(seed);
  for (int n = 0; n < triangles; ++n) {
    const Vec3 at = random.in_cube(1), middle = center + at * (radius / length(at));
    const auto corner = [&] { return middle + random.in_cube(radius / 30); };
    const Vec3 a = corner(), b = corner();
    add_triangle(mesh, a, b, corner());
  }
}

const Grid kAfarGrid{{33, 31, 36}, {-3, -2, -1}, {3.1, 2.3, 3.4}};

TEST(TilesAfar, AMeshSmallerThanASampleAndAStrayTriangle) {
  for (const double radius : {10.0, 1e-2, 1e-4}) {
    Mesh mesh;
    add_ball(mesh, 1, 1500, {1, 2, 0.5}, radius);
    add_triangle(mesh, {100, 60, 118}, {100, 60 + radius, 118}, {100 + radius, 60, 118});
    expect_bits_of_all(mesh, kAfarGrid, 113, "radius " + std::to_string(radius));
  }
}

// Far smaller than a sample, all triangles are specks. From the smallest ball's many lie in the same place.
TEST(TilesAfar, AMeshOfSpecks) {
  for (const double radius : {1e-4, 1e-5, 1e-6, 1e-9}) {
    Mesh mesh;
    add_ball(mesh, 7, 9000, {1, 2, 0.5}, radius);  // more than a table holds
    add_triangle(mesh, {100, 60, 118}, {100, 61, 118}, {101, 60, 118});
    expect_bits_of_all(mesh, kAfarGrid, 397, "radius " + std::to_string(radius));
  }
}

TEST(TilesAfar, SpecksAmongLargerTriangles) {
  Mesh mesh;
  add_ball(mesh, 8, 2000, {1, 2, 0.5}, 1e-5);
  add_ball(mesh, 9, 700, {1, 2, 0.5}, 1e-4);
  Random random(10);
  for (int n = 0; n < 300; ++n) {
    const Vec3 at = Vec3{1, 2, 0.5} + random.in_cube(1e-5);
    add_triangle(mesh, at, at + random.in_cube(0.3), at + random.in_cube(0.3));
  }
  expect_bits_of_all(mesh, kAfarGrid, 113, "larger");
}

TEST(TilesAfar, FewSpecksAmongLargerTriangles) {
  // Too few for the kernel of specks: they are measured as triangles without extent.
  Mesh mesh;
  add_ball(mesh, 15, 900, {1, 2, 0.5}, 0.03);
  Random random(16);
  for (int n = 0; n < 200; ++n) {
    const Vec3 at = Vec3{1, 2, 0.5} + random.in_cube(0.03);
    add_triangle(mesh, at, at + random.in_cube(3e-6), at + random.in_cube(3e-6));
  }
  expect_bits_of_all(mesh, kAfarGrid, 113, "few");
}

TEST(TilesAfar, FewOfManySpecksAreMeasured) {
  // All 20,000 from each sample, if they are culled by boxes and by distances in frames alone.
  Mesh mesh;
  add_ball(mesh, 11, 20000, {1, 2, 0.5}, 3e-4);
  const ComputeReport report = computed(mesh, kAfarGrid, kInfinity).report;
  EXPECT_LT(report.samples_examined, 6000 * kAfarGrid.sample_count());
}

TEST(TilesAfar, FewLargerTrianglesLeaveSpecksSpecks) {
  // If a brick gives up specks for one larger triangle, 40 times as many distances are computed.
  const Vec3 middle{40.3, -20, 30.7};
  Mesh mesh = moved(welded_ball(3e-4, 75), middle);
  Random random(17);
  const auto corner = [&] { return middle + random.in_cube(0.05); };
  for (int n = 0; n < 2; ++n) {
    const Vec3 a = corner(), b = corner();
    add_triangle(mesh, a, b, corner());
  }
  const Grid grid{{32, 32, 32}, {0, 0, 0}, {1, 1, 1}};
  EXPECT_LT(computed(mesh, grid, kInfinity).report.samples_examined, 5000 * grid.sample_count());
}

TEST(TilesAfar, ThickBandsOfSpecksAndAnyOrder) {
  Mesh mesh;
  add_ball(mesh, 12, 1500, {40, 30, 50}, 1e-5);
  const DistanceField full = computed(mesh, kAfarGrid, kInfinity).field;
  const double thickness = 17 * kAfarGrid.max_spacing();
  Mesh reversed = mesh;
  std::ranges::reverse(reversed.triangles);
  const DistanceField band = computed(mesh, kAfarGrid, thickness).field,
                      turned = computed(reversed, kAfarGrid, kInfinity).field;
  for_each_sample(kAfarGrid, [&](auto i, auto j, auto k) {
    ASSERT_EQ(band.value(i, j, k), std::min(full.value(i, j, k), static_cast<float>(thickness)));
    ASSERT_EQ(turned.value(i, j, k), full.value(i, j, k));
  });
}

// Whatever counts as a point, values keep the promise.
TEST(TilesAfar, SpecksKeepThePromise) {
  Mesh mesh;
  Random random(13);
  for (int n = 0; n < 400; ++n) {
    const Vec3 at = Vec3{20, 20, 20} + random.in_cube(30);
    const double side = std::pow(10.0, random.between(-7, -4));
    add_triangle(mesh, at, at + random.in_cube(side), at + random.in_cube(side));
  }
  expect_exact(mesh, computed(mesh, kAfarGrid, kInfinity).field, reference_distances(mesh, kAfarGrid));
}

TEST(TilesAfar, AnyInstructionSet) {
  Mesh mesh;
  add_ball(mesh, 6, 1000, {1, 2, 0.5}, 1e-2);
  add_ball(mesh, 14, 1000, {40, 30, 50}, 1e-6);
  const Grid grid{{17, 15, 16}, {-3, -2, -1}, {6.1, 7.3, 7.4}};
  const DistanceField field = computed(mesh, grid, kInfinity).field;
  for (const Simd simd : {Simd::portable, Simd::avx2}) try {
      expect_same_bits(field, computed(mesh, grid, kInfinity, simd).field);
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("instruction set"), std::string::npos) << error.what();
    }
}

TEST(TilesAfar, SeveralClustersFarApart) {
  Mesh mesh;
  Random random(2);
  for (unsigned n = 0; n < 6; ++n)
    add_ball(mesh, 10 + n, 900, Vec3{50, 30, 60} + random.in_cube(40), std::pow(10.0, -static_cast<double>(n)));
  expect_bits_of_all(mesh, kAfarGrid, 113, "clusters");
}

TEST(TilesAfar, TrianglesThatAreNearlyPoints) {
  for (const double side : {0.0, 1e-6, 1e-4}) {
    Random random(3);
    Mesh mesh;
    for (int n = 0; n < 1500; ++n) {
      const Vec3 at = Vec3{5, 5, 5} + random.in_cube(0.02);
      add_triangle(mesh, at, at + random.in_cube(side), at + random.in_cube(side));
    }
    expect_bits_of_all(mesh, kAfarGrid, 113, "side " + std::to_string(side));
  }
}

TEST(TilesAfar, OutsideTheGridAndAmongLongTriangles) {
  Mesh mesh;
  add_ball(mesh, 4, 2500, {-300, 200, 30}, 0.5);
  Random random(5);
  for (int n = 0; n < 40; ++n)
    add_triangle(mesh, Vec3{-300, 200, 30} + random.in_cube(40), Vec3{-330, 200, 30} + random.in_cube(40),
                 Vec3{-300, 240, 30} + random.in_cube(40));
  expect_bits_of_all(mesh, kAfarGrid, 113, "outside");
}

}  // namespace
}  // namespace standoff::testing
