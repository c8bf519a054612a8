// SPDX-License-Identifier: Apache-2.0
// Meshes with fewer triangles for shadows: nothing large or far from the rest goes missing.
#include "render/light.h"

#include <gtest/gtest.h>

#include <random>

namespace standoff {
namespace {

constexpr float kSize = 1 / 10.0F;

struct Places {
  std::vector<Float3> places;
  std::vector<Triangle> triangles;
};

// Triangles of all sizes in the unit ball's cube.
Places random_triangles(float largest) {
  std::mt19937 random(5);
  const auto number = [&](float most) { return most * (static_cast<float>(random() % 2001) / 1000 - 1); };
  Places mesh;
  for (std::uint32_t n = 0; n < 20000; ++n) {
    const Float3 at{number(0.9F), number(0.9F), number(0.9F)};
    const float size = largest * static_cast<float>(random() % 1000) / 1000;
    for (int corner = 0; corner < 3; ++corner)
      mesh.places.push_back(at + Float3{number(size), number(size), number(size)});
    mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  return mesh;
}

TEST(Thinned, EveryTriangleIsKeptOrNearOneThatIs) {
  const Places mesh = random_triangles(0.02F);
  const std::vector<Triangle> kept = thinned(mesh.places, mesh.triangles, kSize);
  EXPECT_LT(kept.size(), mesh.triangles.size() / 2);
  for (const Triangle& t : mesh.triangles) {
    float least = 9;
    for (const Triangle& k : kept) least = std::min(least, length(mesh.places[t[0]] - mesh.places[k[0]]));
    ASSERT_LE(least, std::sqrt(3.0F) * kSize * 1.001F);
  }
}

TEST(Thinned, LargeTrianglesAreAllKeptInTheirOrder) {
  const Places mesh = random_triangles(0.2F);
  const std::vector<Triangle> kept = thinned(mesh.places, mesh.triangles, 0.001F);
  ASSERT_GT(kept.size(), mesh.triangles.size() * 9 / 10);
  EXPECT_TRUE(std::ranges::is_sorted(kept));
  for (const Triangle& t : mesh.triangles) {
    const Float3 d = mesh.places[t[1]] - mesh.places[t[0]];
    if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) < 0.001F) continue;
    EXPECT_TRUE(std::ranges::binary_search(kept, t));
  }
}

TEST(Thinned, PlacesOnTheSpheresEndsHaveCubes) {
  const std::vector<Float3> places{{1, 1, 1}, {1, 1, 0.999F}, {-1, -1, -1}, {-1.0001F, -1, -1}};
  const std::vector<Triangle> triangles{{0, 1, 0}, {2, 3, 2}, {0, 0, 1}};
  EXPECT_EQ(thinned(places, triangles, kSize), (std::vector<Triangle>{{0, 1, 0}, {2, 3, 2}}));
}

}  // namespace
}  // namespace standoff
