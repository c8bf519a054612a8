// SPDX-License-Identifier: Apache-2.0
// Surfaces of fields are closed, oriented manifolds whatever the field, and those of shapes are where they belong.
#include <gtest/gtest.h>

#include <numbers>

#include "standoff/compute.h"
#include "standoff/surface.h"
#include "surface/cells.h"
#include "tests/surface/manifold.h"
#include "tests/surface/random_field.h"

namespace standoff {
namespace {

using namespace testing;

class EachMethod : public ::testing::TestWithParam<SurfaceMethod> {
 protected:
  SurfaceOptions at(double level) const { return {.at = level, .method = GetParam()}; }
};

const Grid kGrids[] = {
    {{17, 10, 9}, {}, {1, 1, 1}},
    {{8, 8, 8}, {-3, 5, 7}, {1, 0.25, 3}},
    {{9, 9, 8}, {1000, -2000, 0.1}, {0.1, 0.1, 0.1}},
    {{40, 1, 13}, {}, {1, 1, 1}},  // one sample thick
    {{1, 1, 300}, {}, {2, 2, 2}},
    {{1, 1, 1}, {}, {1, 1, 1}},
    {{7, 10, 9}, {1e9, 1e9, -1e9}, {0.5, 0.5, 0.5}},  // no floats
    {{6, 9, 6}, {1e-20, 0, 0}, {1e-20, 1e-20, 1e-20}},
    {{6, 9, 6}, {}, {1e30, 1e30, 1e30}},
    {{6, 9, 6}, {}, {1e60, 1e60, 1e60}},
};

TEST_P(EachMethod, NoiseHasAManifoldSurface) {
  int surfaces = 0;
  for (const Grid& grid : kGrids)
    for (const Noise noise : {Noise::smooth, Noise::integers, Noise::extremes})
      for (unsigned seed = 0; seed < 3; ++seed) {
        const DistanceField field = noise_field(grid, noise, seed);
        for (const double level : {0.0, 0.25, 1.0, -1.0}) {
          const SurfaceResult found = surface(field, at(level));
          ASSERT_EQ(manifold_fault(found.mesh), "")
              << "grid of " << grid.size.x << ", noise " << int(noise) << ", seed " << seed << ", level " << level;
          surfaces += !found.mesh.triangles.empty();
        }
      }
  EXPECT_GT(surfaces, 300);
}

// The sum of a closed surface's signed volumes is positive if it faces outwards, and every sample is on its side.
TEST_P(EachMethod, NoiseIsInside) {
  const Grid grid{{6, 6, 6}, {}, {1, 1, 1}};
  for (unsigned seed = 0; seed < 4; ++seed) {
    const DistanceField field = noise_field(grid, Noise::smooth, seed);
    const Mesh mesh = surface(field, at(0)).mesh;
    const DistanceField again = compute(mesh, grid, kFullField, {.sign = {SignMethod::winding}}).field;
    for (std::int64_t n = 0; n < 216; ++n)
      EXPECT_EQ(again.value(n % 6, n / 6 % 6, n / 36) < 0, field.value(n % 6, n / 6 % 6, n / 36) < 0) << n;
  }
}

TEST_P(EachMethod, SphereHasItsVolumeAndArea) {
  const double radius = 1;
  double last_error = 1;
  for (const std::int64_t samples : {15, 30, 60}) {
    const Grid grid = fit_resolution({{-1, -1, -1}, {1, 1, 1}}, samples);
    const Mesh mesh = surface(field_of(grid, [&](Vec3 p) { return length(p) - radius; }), at(0)).mesh;
    EXPECT_EQ(manifold_fault(mesh), "");
    EXPECT_EQ(euler_characteristic(mesh), 2);
    const double error = std::abs(volume(mesh) - 4 * std::numbers::pi / 3);
    EXPECT_LT(error, 0.3 * last_error) << "quadratic in the spacing";
    EXPECT_LT(error, 8 * grid.spacing.x * grid.spacing.x);
    EXPECT_NEAR(area(mesh), 4 * std::numbers::pi, 12 * grid.spacing.x * grid.spacing.x);
    last_error = error;
  }
}

TEST_P(EachMethod, TorusHasItsVolumeAndHole) {
  const Grid grid{{70, 80, 40}, {-1.45, -1.46, -0.45}, {0.043, 0.037, 0.0229}};
  const auto torus = [](Vec3 p) { return std::hypot(std::hypot(p.x, p.y) - 1, p.z) - 0.3; };
  const Mesh mesh = surface(field_of(grid, torus), at(0)).mesh;
  EXPECT_EQ(manifold_fault(mesh), "");
  EXPECT_EQ(euler_characteristic(mesh), 0);
  EXPECT_NEAR(volume(mesh), 2 * std::numbers::pi * std::numbers::pi * 0.09, 0.02);
  // Each vertex is on the surface, as far as interpolation knows it.
  for (const Vec3& v : mesh.vertices) EXPECT_NEAR(torus(v), 0, 3e-3);
}

TEST_P(EachMethod, AnAxisAlignedBoxIsExact) {
  const Grid grid{{24, 20, 22}, {-0.3, -0.3, -0.3}, {0.1, 0.1, 0.1}};
  // Faces halfway between samples: linear interpolation is exact on all but the edges.
  const auto box = [](Vec3 p) {
    const Vec3 d = max(Vec3{0.05, 0.05, 0.05} - p, p - Vec3{1.65, 1.25, 1.45});
    return std::max({d.x, d.y, d.z});
  };
  const Mesh mesh = surface(field_of(grid, box), at(0)).mesh;
  EXPECT_EQ(manifold_fault(mesh), "");
  EXPECT_NEAR(volume(mesh), 1.6 * 1.2 * 1.4, GetParam() == SurfaceMethod::dual ? 0.02 : 0.05);
}

// The solid fills the grid: its surface is the grid's box, closed by the clearance beyond it.
TEST_P(EachMethod, ASolidThatLeavesTheGridIsCapped) {
  const Grid grid{{9, 8, 17}, {1, 2, 3}, {0.5, 0.5, 0.5}};
  DistanceField full(grid, 1);  // no stored tiles at all
  for (std::int64_t z = 0; z < 3; ++z)
    for (std::int64_t x = 0; x < 2; ++x) full.mark_inside(x, 0, z);
  for (const DistanceField& field : {field_of(grid, [](Vec3) { return -1; }), full}) {
    const SurfaceResult found = surface(field, at(0));
    EXPECT_EQ(manifold_fault(found.mesh), "");
    EXPECT_EQ(euler_characteristic(found.mesh), 2);
    EXPECT_NEAR(volume(found.mesh), 4.0 * 3.5 * 8.0, GetParam() == SurfaceMethod::dual ? 0.1 : 0.3);
    EXPECT_EQ(found.report.capped, 2 * (9 * 8 + 9 * 17 + 8 * 17));
    EXPECT_EQ(found.report.clamped, 0);
  }
}

// Neighbouring tiles that are not stored and have opposite signs: fields of open meshes have them.
TEST_P(EachMethod, OppositeBackgroundsAreSeparated) {
  DistanceField field({{32, 32, 32}, {}, {1, 1, 1}}, 2);
  field.mark_inside(1, 1, 1);
  field.mark_inside(2, 2, 1);  // joined along an edge: ambiguous faces
  field.mark_inside(2, 2, 2);
  const SurfaceResult found = surface(field, at(0));
  EXPECT_EQ(manifold_fault(found.mesh), "");
  EXPECT_NEAR(volume(found.mesh), 3 * 512, 60);
  EXPECT_EQ(found.report.clamped, 6 * 64 * 3 - 2 * 64) << "all edges between them";
  EXPECT_GT(found.report.ambiguous_faces, 0);
}

TEST_P(EachMethod, EmptyAndFullFields) {
  const Grid grid{{9, 9, 9}, {}, {1, 1, 1}};
  EXPECT_TRUE(surface(DistanceField(grid, 2), at(0)).mesh.triangles.empty());
  EXPECT_TRUE(surface(DistanceField(), at(0)).mesh.triangles.empty());
  EXPECT_TRUE(surface(field_of(grid, [](Vec3) { return 0; }), at(0)).mesh.triangles.empty()) << "0 is outside";
  EXPECT_FALSE(surface(field_of(grid, [](Vec3) { return 0; }), at(1e-30)).mesh.triangles.empty());
}

TEST_P(EachMethod, ThreadsChangeNothing) {
  const DistanceField field = noise_field({{30, 20, 18}, {}, {1, 1, 1}}, Noise::smooth, 5);
  SurfaceOptions options = at(0.1);
  options.execution.threads = 1;
  const SurfaceResult one = surface(field, options);
  for (const int threads : {2, 5}) {
    options.execution.threads = threads;
    const SurfaceResult many = surface(field, options);
    EXPECT_EQ(many.mesh.vertices, one.mesh.vertices);
    EXPECT_EQ(many.mesh.triangles, one.mesh.triangles);
    EXPECT_EQ(many.report.ambiguous_faces, one.report.ambiguous_faces);
  }
}

TEST_P(EachMethod, SparseAndDenseFieldsHaveTheSameSurface) {
  const Grid grid{{61, 50, 47}, {-1, -1, -1}, {0.05, 0.05, 0.05}};
  const auto ball = [](Vec3 p) { return length(p - Vec3{0.5, 0.2, 0.1}) - 0.6; };
  const DistanceField full = field_of(grid, ball);
  const DistanceField band = DistanceField::from_dense(grid, 0.2, full.to_dense());
  ASSERT_LT(band.stored_tiles(), full.stored_tiles());
  const SurfaceResult sparse = surface(band, at(0.03)), dense = surface(full, at(0.03));
  EXPECT_EQ(sparse.mesh.vertices, dense.mesh.vertices);
  EXPECT_EQ(sparse.mesh.triangles, dense.mesh.triangles);
}

TEST_P(EachMethod, AWallMakesASolidHollow) {
  const Grid grid = fit_resolution({{-1, -1, -1}, {1, 1, 1}}, 60);
  const DistanceField field = field_of(grid, [](Vec3 p) { return length(p) - 1; });
  SurfaceOptions options = at(0);
  options.wall = 0.25;
  const SurfaceResult hollow = surface(field, options);
  EXPECT_EQ(manifold_fault(hollow.mesh), "");
  EXPECT_EQ(euler_characteristic(hollow.mesh), 4);
  EXPECT_NEAR(volume(hollow.mesh), 4 * std::numbers::pi / 3 * (1 - 0.75 * 0.75 * 0.75), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Methods, EachMethod, ::testing::Values(SurfaceMethod::marching_cubes, SurfaceMethod::dual),
                         [](const auto& method) { return method.param == SurfaceMethod::dual ? "dual" : "cubes"; });

TEST(CellCases, EachEdgeWithAnEndInsideIsOnOneLoop) {
  const CellCases& cases = CellCases::table();
  for (std::uint32_t inside = 0; inside < 256; ++inside) {
    const std::uint32_t faces = cases.ambiguous(inside);
    for (std::uint32_t joined = faces;; joined = (joined - 1) & faces) {
      const CellCase& found = cases.find(inside, joined);
      int edges = 0, in_triangles = 0;
      for (int edge = 0; edge < kCellEdges; ++edge) {
        const int corner = edge_corner(edge);
        const bool crossed = (inside >> corner & 1) != (inside >> (corner + (1 << edge_axis(edge))) & 1);
        EXPECT_EQ(found.loop_of[static_cast<std::size_t>(edge)] < found.loop_count, crossed);
        edges += crossed;
      }
      for (int loop = 0; loop < found.loop_count; ++loop) in_triangles += static_cast<int>(found.loop(loop).size()) - 2;
      EXPECT_EQ(found.triangle_count, in_triangles + (found.centre_loop >= 0 ? 2 : 0));
      EXPECT_EQ(edges > 0, inside != 0 && inside != 255);
      if (joined == 0) break;
    }
  }
}

}  // namespace
}  // namespace standoff
