// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
// Signs by pseudonormals: against tetrahedra, whose insides integers tell, with points where the normal of one face is
// wrong and where the mean of all is; against terrain; and beyond the band.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "scenes/scenes.h"
#include "sign/normal/pseudonormals.h"
#include "standoff/compute.h"
#include "tests/sign/shapes.h"
#include "tests/sign/solid_soup.h"
#include "tests/support/fields.h"

namespace standoff::testing {
namespace {

using NormalPlace = Pseudonormals::Place;

ComputeOptions by(SignMethod method, bool nearest = false) { return {.sign = {.method = method}, .nearest = nearest}; }

std::vector<Tetrahedron> outward_tetrahedron(Random& random, std::uint32_t half) {
  while (true) {
    std::vector<Tetrahedron> one = integer_tetrahedra(random, 1, half);
    Tetrahedron& t = one[0];
    const int side = orientation(t[0], t[1], t[2], t[3]);
    if (side == 0) continue;
    if (side < 0) std::swap(t[0], t[1]);
    return one;
  }
}

// The same solid: two faces are cut into many triangles at corners 0, each time at a point within, nearer to a side.
Mesh with_fans(const Tetrahedron& t, int cuts) {
  const Mesh plain = mesh_of({t});
  Mesh mesh;
  for (std::size_t f = 0; f < plain.triangles.size(); ++f) {
    auto [a, b, c] = MeshView(plain).corners(f);
    for (int n = 0; n < cuts && (f == 1 || f == 2); ++n) {
      const Vec3 within = (a + b + c * 2) * 0.25;  // exact
      add_triangle(mesh, b, c, within);
      add_triangle(mesh, c, a, within);
      c = within;
    }
    add_triangle(mesh, a, b, c);
  }
  return mesh;
}

TEST(Pseudonormals, OfSharpCornersWhicheverTriangleIsNamed) {
  std::int64_t face_normal_wrong = 0, behind = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const std::vector<Tetrahedron> solid = outward_tetrahedron(random, 9);
    for (const int cuts : {0, 12}) {
      const Mesh mesh = with_fans(solid[0], cuts);
      const Pseudonormals normals({mesh});
      for (int n = 0; n < 200; ++n) {
        const Vec3 at = random.in_cube(12), p{std::round(at.x), std::round(at.y), std::round(at.z)};
        const auto known = known_winding(solid, p);
        if (known.on_surface) continue;
        const double distance = reference_distance(mesh, p);
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
          if (reference_distance(mesh, t, p) > distance * (1 + 1e-12)) continue;
          EXPECT_EQ(normals.place_of(p, t), known.winding != 0 ? NormalPlace::back : NormalPlace::front)
              << seed << ", " << cuts << ", triangle " << t;
          behind += known.winding != 0;
          const auto [a, b, c] = MeshView(mesh).corners(t);
          face_normal_wrong += (dot(cross(b - a, c - a), p - a) < 0) != (known.winding != 0);
        }
      }
    }
  }
  EXPECT_GT(face_normal_wrong, 1000);
  EXPECT_GT(behind, 50);
}

TEST(Pseudonormals, OrientationOfUseAndTrianglesLeftOut) {
  Random random(3);
  const Mesh mesh = mesh_of(outward_tetrahedron(random, 9));
  Mesh damaged = mesh;  // some turned around, one of them twice, and each face again, turned around
  std::swap(damaged.triangles[1][0], damaged.triangles[1][1]);
  std::swap(damaged.triangles[3][0], damaged.triangles[3][2]);
  for (std::size_t t = 0; t < 4; ++t) {
    const Triangle& as_is = mesh.triangles[t];
    damaged.triangles.push_back({as_is[2], as_is[1], as_is[0]});
  }
  const std::vector<std::int8_t> use = {1, -1, 0, -1, 0, 0, -1, 0};
  const Pseudonormals plain({mesh}), repaired({damaged, use}), cancelled({damaged, std::vector<std::int8_t>(8)});
  for (int n = 0; n < 300; ++n) {
    const Vec3 p = random.in_cube(12);
    for (std::uint32_t t = 0; t < 4; ++t) {
      const NormalPlace place = plain.place_of(p, t);
      EXPECT_EQ(repaired.place_of(p, t), place);
      EXPECT_EQ(repaired.place_of(p, t + 4), place);
      EXPECT_EQ(cancelled.place_of(p, t), NormalPlace::front);
    }
  }
}

std::int64_t wrong_signs(const DistanceField& field, const DistanceField& expected) {
  std::int64_t wrong = 0;
  for_each_sample(field.grid(), [&](auto i, auto j, auto k) {
    wrong += field.value(i, j, k) != expected.value(i, j, k) && std::abs(field.value(i, j, k)) > 1e-6;
  });
  return wrong;
}

// What the winding number gives off the surface; beyond a band thinner than a sample as well.
TEST(NormalSign, OfSolidsIsThatOfTheWindingNumber) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    Random random(seed);
    const Mesh mesh = mesh_of(outward_tetrahedron(random, 9));
    const Grid grid{{42, 37, 40}, {-10.2, -9.1, -9.9}, {0.5, 0.51, 0.49}};
    for (const double thickness : {0.2, 0.6, 2.0, kFullField})
      EXPECT_EQ(wrong_signs(compute(mesh, grid, thickness, by(SignMethod::normal)).field,
                            compute(mesh, grid, thickness, by(SignMethod::winding)).field),
                0)
          << seed << ", " << thickness;
  }
  const Mesh sphere = scenes::make("sphere", 3000);
  const Grid grid = fit_resolution(bounds(sphere), 70);
  for (const double thickness : {0.3 * grid.spacing.x, 2 * grid.spacing.x})
    EXPECT_EQ(wrong_signs(compute(sphere, grid, thickness, by(SignMethod::normal)).field,
                          compute(sphere, grid, thickness, by(SignMethod::winding)).field),
              0);
}

// A solid that lines from the origin leave once, with spikes and pits.
Mesh star(Random& random) {
  Mesh mesh = sphere(6);
  std::map<std::array<double, 3>, double> far;  // vertices on the seam are one position
  for (Vec3& v : mesh.vertices) {
    const auto [at, is_new] = far.try_emplace({v.x, v.y, v.z});
    if (is_new) at->second = random.between(1, 7);
    v = v * at->second;
  }
  return mesh;
}

// Bands so thin that samples on one side of a region, or on both, or of all the grid, have no nearest triangle.
TEST(NormalSign, OfSolidsIsThatOfTheWindingNumberForAnyBandAndGrid) {
  std::int64_t inside = 0, all_inside = 0, no_tile = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const bool is_star = random.below(2) == 0;
    const Tetrahedron corners = outward_tetrahedron(random, 9)[0];
    const Mesh mesh = is_star ? star(random) : mesh_of({corners});
    const auto samples = [&] { return static_cast<std::int64_t>(random.between(1, 30)); };
    const auto step = [&] { return random.between(0.1, 1); };
    Grid grid{{samples(), samples(), samples()}, random.in_cube(5) - Vec3{3, 3, 3}, {step(), step(), step()}};
    if (seed % 2 == 1) {  // within the solid, or nearly
      grid.origin = is_star ? Vec3{} : (corners[0] + corners[1] + corners[2] + corners[3]) * 0.25;
      grid.spacing = grid.spacing * 0.03;
    }
    const double thickness = std::pow(10, random.between(-4, 1));
    const DistanceField field = compute(mesh, grid, thickness, by(SignMethod::normal)).field;
    EXPECT_EQ(wrong_signs(field, compute(mesh, grid, thickness, by(SignMethod::winding)).field), 0)
        << seed << ", " << thickness;
    std::int64_t here = 0;
    for (const float value : field.to_dense()) here += value < 0;
    inside += here;
    all_inside += here == grid.sample_count();
    no_tile += field.stored_tiles() == 0;
  }
  EXPECT_GT(inside, 10000);
  EXPECT_GT(all_inside, 10);
  EXPECT_GT(no_tile, 10);
}

// Nested cubes between all samples, turned alternately: each layer is a region without any nearest triangle.
TEST(NormalSign, OfManyRegionsWithoutABand) {
  Mesh mesh;
  constexpr int kShells = 12;
  for (int n = 0; n < kShells; ++n) {
    const Mesh cube = box(Vec3{-1, -1, -1} * (n + 1.5), Vec3{1, 1, 1} * (n + 1.5));
    mesh = joined(std::move(mesh), (kShells - n) % 2 == 1 ? cube : reversed(cube));
  }
  const Grid grid{{31, 31, 31}, {-15, -15, -15}, {1, 1, 1}};
  const DistanceField field = compute(mesh, grid, 0.01, by(SignMethod::normal)).field;
  std::int64_t wrong = 0;
  for_each_sample(grid, [&](auto i, auto j, auto k) {
    const auto far = static_cast<std::int64_t>(max_norm(grid.position(i, j, k)));
    const std::int64_t shells_around = kShells - std::clamp<std::int64_t>(far - 1, 0, kShells);
    wrong += (field.value(i, j, k) < 0) != (shells_around % 2 == 1);
  });
  EXPECT_EQ(wrong, 0);
}

double height(double x, double y) { return 0.4 * std::sin(2 * x) * std::cos(1.5 * y) + 0.1 * x; }

// Squares of a net, each of two triangles, over [-3, 3] x [-3, 3], facing up.
Mesh terrain(int squares) {
  Mesh mesh;
  const auto at = [&](int i, int j) {
    const double x = -3 + 6.0 * i / squares, y = -3 + 6.0 * j / squares;
    return Vec3{x, y, height(x, y)};
  };
  for (int j = 0; j < squares; ++j)
    for (int i = 0; i < squares; ++i) {
      add_triangle(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add_triangle(mesh, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return mesh;
}

// The terrain's height at a point, by its triangle.
double height_of_net(int squares, const Vec3& p) {
  const double u = (p.x + 3) * squares / 6, v = (p.y + 3) * squares / 6;
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  const auto at = [&](int m, int n) { return height(-3 + 6.0 * m / squares, -3 + 6.0 * n / squares); };
  const double a = u - i, b = v - j;
  if (a >= b) return at(i, j) + a * (at(i + 1, j) - at(i, j)) + b * (at(i + 1, j + 1) - at(i + 1, j));
  return at(i, j) + b * (at(i, j + 1) - at(i, j)) + a * (at(i + 1, j + 1) - at(i, j + 1));
}

TEST(NormalSign, OfTerrainIsBelowIt) {
  constexpr int kSquares = 20;
  const Mesh mesh = terrain(kSquares);
  const Grid grid{{41, 39, 52}, {-2.03, -1.91, -2.53}, {0.1, 0.1, 0.1}};
  for (const double thickness : {1e-6, 0.03, 0.13, 0.5, kFullField}) {
    const DistanceField field = compute(mesh, grid, thickness, by(SignMethod::normal)).field;
    std::int64_t wrong = 0, below = 0;
    for_each_sample(grid, [&](auto i, auto j, auto k) {
      const Vec3 p = grid.position(i, j, k);
      const double above = p.z - height_of_net(kSquares, p);
      wrong += std::abs(above) > 1e-9 && (field.value(i, j, k) < 0) != (above < 0);
      below += above < 0;
    });
    EXPECT_EQ(wrong, 0) << thickness;
    EXPECT_GT(below, 20000);
  }
}

// Where the grid reaches beyond the sheet, both sides spread from it, each over its own half.
TEST(NormalSign, BeyondTheEndOfASheet) {
  const Mesh mesh = terrain(12);
  const Grid grid{{90, 90, 90}, {-4.5, -4.5, -4.5}, {0.1, 0.1, 0.1}};
  const DistanceField field = compute(mesh, grid, 0.15, by(SignMethod::normal)).field;
  for (std::int64_t k = 0; k < 90; k += 89) {
    EXPECT_EQ(field.value(45, 45, k) < 0, k == 0);
    EXPECT_EQ(field.value(20, 60, k) < 0, k == 0);
  }
}

TEST(NormalSign, SparseAndDenseWithAndWithoutNearestTriangles) {
  const Mesh mesh = terrain(9);  // open, and its band ends within the grid
  const Grid grid{{37, 35, 34}, {-3.6, -3.4, -3.3}, {0.2, 0.2, 0.2}};
  for (const double thickness : {1e-5, 0.07, 0.5, kFullField}) {
    const DistanceField plain = compute(mesh, grid, thickness, {.sign = {SignMethod::none}}).field;
    const DistanceField with = compute(mesh, grid, thickness, by(SignMethod::normal, true)).field;
    DistanceField without = compute(mesh, grid, thickness, by(SignMethod::normal)).field;
    EXPECT_TRUE(with.has_nearest());
    EXPECT_FALSE(without.has_nearest());
    EXPECT_EQ(wrong_signs(with, without), 0);
    std::vector<float> dense(static_cast<std::size_t>(grid.sample_count()));
    compute_into(mesh, grid, thickness, dense, by(SignMethod::normal));
    EXPECT_EQ(bits_of(dense), bits_of(without.to_dense()));
    std::vector<float> magnitudes = dense;
    for (float& value : magnitudes) value = std::abs(value);
    EXPECT_EQ(bits_of(magnitudes), bits_of(plain.to_dense()));
    for (const int threads : {1, 4}) {
      ComputeOptions options = by(SignMethod::normal);
      options.execution.threads = threads;
      compute_into(mesh, grid, thickness, without, options);  // into a field that was used before
      EXPECT_EQ(bits_of(dense), bits_of(without.to_dense()));
    }
  }
}

}  // namespace
}  // namespace standoff::testing
