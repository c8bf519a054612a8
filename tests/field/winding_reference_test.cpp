// SPDX-License-Identifier: Apache-2.0
// Compares the winding numbers that signs are checked with, with 128-bit integers and with each other.
#include "field/reference.h"

#include <gtest/gtest.h>

#include "scenes/scenes.h"
#include "tests/sign/solid_soup.h"

namespace standoff::testing {
namespace {

std::vector<Tetrahedron> without_flat_ones(std::vector<Tetrahedron> all) {
  std::erase_if(all, [](const auto& t) { return orientation(t[0], t[1], t[2], t[3]) == 0; });
  return all;
}

// All points of a lattice are in planes of triangles, and many on their edges and corners.
TEST(WindingReference, CrossingsAreExact) {
  std::int64_t inside = 0, on_surface = 0;
  for (unsigned seed = 0; seed < 30; ++seed) {
    Random random(seed);
    const auto solids = without_flat_ones(integer_tetrahedra(random, 8, 4));
    const Mesh mesh = mesh_of(solids);
    const TriangleGroups groups(mesh);
    for (int n = 0; n < 11 * 11 * 11; ++n) {
      const Vec3 p{double(n % 11 - 5), double(n / 11 % 11 - 5), double(n / 121 - 5)};
      bool on = false;
      std::int32_t winding = 0;
      for (const auto& solid : solids) {
        const auto known = known_winding({solid}, p);
        on = on || known.on_surface;
        winding += known.winding;
      }
      const ReferenceWinding found = winding_by_crossings({mesh}, groups, p);
      ASSERT_EQ(found.on_surface, on) << seed << ", " << n;
      ASSERT_TRUE(on || found.value == winding) << seed << ", " << n;
      inside += !on && winding != 0;
      on_surface += on;
    }
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(on_surface, 1000);
}

TEST(WindingReference, PointsOnTrianglesWithoutArea) {
  Mesh mesh;
  add_triangle(mesh, {0, 0, 0}, {2, 4, 6}, {1, 2, 3});
  add_triangle(mesh, {9, 9, 9}, {9, 9, 9}, {9, 9, 9});
  const TriangleGroups groups(mesh);
  const auto on = [&](const Vec3& p) { return winding_by_crossings({mesh}, groups, p).on_surface; };
  EXPECT_TRUE(on({1.5, 3, 4.5}));
  EXPECT_TRUE(on({9, 9, 9}));
  EXPECT_FALSE(on({1.5, 3, 4.5000001}));
  EXPECT_FALSE(on({3, 6, 9}));
  EXPECT_FALSE(on({9, 9, 8}));
}

// Both numbers of a mesh agree, the angles within their stated error.
TEST(WindingReference, AnglesAndCrossingsAgree) {
  for (const char* name : {"catapult", "fly", "nested", "far_away"}) {
    const Mesh mesh = scenes::make(name, 2000);
    const TriangleGroups groups(mesh);
    const Box box = bounds(mesh);
    Random random(1);
    std::int64_t inside = 0;
    for (int n = 0; n < 300; ++n) {
      const Vec3 share{random.between(0, 1), random.between(0, 1), random.between(0, 1)};
      Vec3 p = box.min + box.extent() * share;
      // Points as near to a corner as double allows, or nearly.
      if (n % 3 == 0) p = MeshView(mesh).corner(random.below(static_cast<std::uint32_t>(mesh.triangles.size())), 0);
      if (n % 3 == 0) p.x = std::nextafter(p.x, n % 2 == 0 ? 1e300 : -1e300);
      const ReferenceWinding exact = winding_by_crossings({mesh}, groups, p), angles = winding_by_angles({mesh}, p);
      if (exact.on_surface) continue;
      EXPECT_LE(std::abs(exact.value - angles.value), angles.error) << name << ", " << n;
      EXPECT_TRUE(n % 3 == 0 || angles.error < 1e-9) << name << ", " << n;
      inside += exact.value != 0;
    }
    EXPECT_GT(inside, 20) << name;
  }
}

// A square seen from a point above its middle, and from its corners outwards: the solid angle of a pyramid.
TEST(WindingReference, AnglesOfASquareInClosedForm) {
  const Mesh square{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  for (const double h : {1e-9, 0.1, 1.0, 30.0, 1e5}) {
    const double angle = 4 * std::asin(1 / (1 + h * h)) / (4 * 3.14159265358979323846);
    for (const double side : {1.0, -1.0}) {
      const ReferenceWinding found = winding_by_angles({square}, {0, 0, side * h});
      // The diagonal passes below the point: near it the angles are as uncertain as they say.
      EXPECT_NEAR(found.value, -side * angle, found.error + 1e-15) << h;
      EXPECT_LT(found.error, h < 1e-6 ? 1e-5 : 1e-12) << h;
    }
  }
  EXPECT_EQ(winding_by_angles({square}, {1, 1, 0}).error, std::numeric_limits<double>::infinity());
  EXPECT_GE(winding_by_angles({square}, {0.5, 0.5, 0}).error, 0.5) << "on the diagonal";
}

TEST(WindingReference, TrianglesAreUsedAsTheirOrientationSays) {
  const Tetrahedron t{Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}, Vec3{0, 0, 4}};
  const Mesh mesh = mesh_of({t, t});
  const TriangleGroups groups(mesh);
  const auto both = [&](const std::vector<std::int8_t>& use) {
    const Vec3 p{0.5, 0.6, 0.7};
    const double crossings = winding_by_crossings({mesh, use}, groups, p).value;
    EXPECT_NEAR(winding_by_angles({mesh, use}, p).value, crossings, 1e-12);
    return crossings;
  };
  EXPECT_EQ(both({}), 2);
  EXPECT_EQ(both({1, 1, 1, 1, -1, -1, -1, -1}), 0);
  EXPECT_EQ(both({-1, -1, -1, -1, -1, -1, -1, -1}), -2);
  EXPECT_EQ(both({1, 1, 1, 1, 0, 0, 0, 0}), 1);
}

}  // namespace
}  // namespace standoff::testing
