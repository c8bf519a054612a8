// SPDX-License-Identifier: Apache-2.0
// The GPU's kernels, emulated: the same bits as the CPU backend, in every order in which threads may take turns.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "gpu/emulation/block.h"
#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "standoff/testing/emulation.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using emulation::Order;
using emulation::OrderScope;
using testing::kInfinity;

void append(Mesh& mesh, const Mesh& other) {
  for (std::size_t t = 0; t < other.triangles.size(); ++t)
    testing::add_triangle(mesh, MeshView(other).corner(t, 0), MeshView(other).corner(t, 1),
                          MeshView(other).corner(t, 2));
}

// Short and long triangles, ties, slivers, segments and points.
Mesh mixed_mesh(Vec3 at = {}) {
  Mesh mesh = testing::nasty_soup(51, 60, 6);
  for (Vec3& v : mesh.vertices) v = v + at;
  append(mesh, testing::random_soup(52, 150, 6, 0.7, at));
  append(mesh, testing::random_soup(53, 6, 8, 20, at));
  return mesh;
}

const Grid kCudaGrid{{25, 19, 18}, {-6, -5, -4.5}, {0.5, 0.5, 0.5}};

ComputeResult on(Backend backend, Method method, MeshView mesh, const Grid& grid, double thickness) {
  ComputeOptions options{.sign = {SignMethod::none}};
  options.method = method;
  options.execution.backend = backend;
  options.nearest = true;
  options.execution.threads = 2;
  return compute(mesh, grid, thickness, options);
}

void expect_same(Method method, MeshView mesh, const Grid& grid, double thickness) {
  const ComputeResult cpu = on(Backend::cpu, method, mesh, grid, thickness);
  for (const Order order : {Order::forward, Order::reverse, Order::random}) {
    SCOPED_TRACE("order " + std::to_string(static_cast<int>(order)) + ", thickness " + std::to_string(thickness));
    const OrderScope scope(order, 11);
    const ComputeResult gpu = on(testing::kEmulated, method, mesh, grid, thickness);
    testing::expect_same_bits(cpu.field, gpu.field);
    EXPECT_EQ(cpu.field.stored_tiles(), gpu.field.stored_tiles());
    EXPECT_EQ(cpu.report.samples_band, gpu.report.samples_band);
    EXPECT_EQ(gpu.report.backend, "emulated");
    if (method == Method::thesis) {
      EXPECT_EQ(cpu.report.samples_examined, gpu.report.samples_examined);
    }
  }
}

TEST(CudaFields, ThinBands) {
  const Mesh mesh = mixed_mesh();
  for (const double thickness : {0.05, 0.9, 1.9}) expect_same(Method::tiles, mesh, kCudaGrid, thickness);
}

TEST(CudaFields, ThickBands) { expect_same(Method::tiles, mixed_mesh(), kCudaGrid, 2.6); }

TEST(CudaFields, FullFields) { expect_same(Method::tiles, mixed_mesh(), kCudaGrid, kInfinity); }

TEST(CudaFields, FarFromTheOriginWithUnequalSpacings) {
  const Vec3 at{1e6, -3e5, 77};
  const Grid grid{{17, 14, 21}, at + Vec3{-6, -5, -4.5}, {0.7, 0.8, 0.5}};
  const Mesh mesh = mixed_mesh(at);
  for (const double thickness : {1.0, kInfinity}) expect_same(Method::tiles, mesh, grid, thickness);
}

TEST(CudaFields, Thesis) {
  const Mesh mesh = mixed_mesh();
  for (const double thickness : {0.9, 2.6, kInfinity}) expect_same(Method::thesis, mesh, kCudaGrid, thickness);
}

TEST(CudaFields, MeshesFarOutsideTheGrid) {
  const Mesh mesh = testing::random_soup(54, 40, 3, 1, {50, 40, -30});
  for (const double thickness : {1.0, kInfinity}) expect_same(Method::tiles, mesh, kCudaGrid, thickness);
  expect_same(Method::thesis, mesh, kCudaGrid, 1.0);
}

TEST(CudaFields, AMeshFarSmallerThanASample) {
  // Its triangles are specks in full fields (field/lattice.h).
  Mesh mesh = testing::random_soup(54, 300, 1e-5, 2e-6);
  append(mesh, testing::random_soup(55, 2, 6, 0.7));
  expect_same(Method::tiles, mesh, kCudaGrid, kInfinity);
  expect_same(Method::tiles, mesh, kCudaGrid, 1.7);
}

// Triangles that are nearest far from the middles of their boxes, in lists of more than a warp takes at once.
TEST(CudaFields, NeedlesAcrossSeveralTiles) {
  std::mt19937 random(57);
  std::uniform_real_distribution<double> at(-6, 6), along(2, 7), across(-0.2, 0.2);
  Mesh mesh;
  for (int n = 0; n < 240; ++n) {
    const Vec3 from{at(random), at(random), at(random)};
    Vec3 to = from + Vec3{across(random), across(random), across(random)};
    to[n % 3] += along(random);
    testing::add_triangle(mesh, from, to, to + Vec3{across(random), across(random), across(random)});
  }
  for (const double thickness : {2.6, kInfinity}) expect_same(Method::tiles, mesh, kCudaGrid, thickness);
}

// The middle of a triangle's box is at the centre of a tile, but the triangle is not: the triangle that is nearest to
// the tile's far corner is farther away than if it were.
TEST(CudaFields, TheMiddleOfABoxIsNoPointOfTheTriangle) {
  const Grid grid{{16, 16, 16}, {0, 0, 0}, {1, 1, 1}};
  const Vec3 center{3.5, 3.5, 3.5};
  Mesh mesh;
  testing::add_triangle(mesh, center + 5.2 * Vec3{1, -1, -1}, center + 5.2 * Vec3{-1, 1, -1},
                        center + 5.2 * Vec3{-1, -1, 1});
  const Vec3 far = center + 7.8 * Vec3{1, 1, 1};
  testing::add_triangle(mesh, far, far + Vec3{0.1, 0, 0}, far + Vec3{0, 0.1, 0});
  expect_same(Method::tiles, mesh, grid, kInfinity);
}

// So far that the triangle, although it is long, counts as its box's middle.
TEST(CudaFields, ALongTriangleThatIsASpeck) {
  Mesh mesh;
  testing::add_triangle(mesh, {0, 0, 1e8}, {20, 0, 1e8 + 9}, {0, 20, 1e8 + 30});
  expect_same(Method::tiles, mesh, {{4, 4, 9}, {0, 0, 0}, {1, 1, 1}}, kInfinity);
}

// From most samples both triangles are equally near, when distances have been rounded: the first one is the nearest. At
// the middle of the grid, the second one is nearer by more than rounding.
TEST(CudaFields, EquallyNearTrianglesInAGridWithoutWidth) {
  Mesh walls;
  for (const double away : {0.04, 0.0001})
    testing::add_triangle(walls, {255.5, away, -500}, {255.5, away, 500}, {255.5, away + 500, 0});
  expect_same(Method::tiles, walls, {{868, 1, 1}, {0, 0, 0}, {1, 1, 1}}, kInfinity);
}

TEST(CudaFields, OneTriangleOnOneSample) {
  const Mesh mesh = testing::random_soup(55, 1, 0.2, 0.5);
  const Grid grid{{1, 1, 1}, {0.1, 0, 0}, {1, 1, 1}};
  for (const double thickness : {2.0, kInfinity}) expect_same(Method::tiles, mesh, grid, thickness);
}

TEST(CudaFields, VerySmallAndVeryLargeUnits) {
  for (const double unit : {1e-9, 1e9}) {
    Mesh mesh = mixed_mesh();
    for (Vec3& v : mesh.vertices) v = v * unit;
    const Grid grid{{14, 13, 12}, Vec3{-6, -5, -4.5} * unit, Vec3{0.8, 0.8, 0.8} * unit};
    for (const double thickness : {unit, kInfinity}) expect_same(Method::tiles, mesh, grid, thickness);
  }
}

// Lists longer than a stage, tiles with more triangles than a chunk, all near each other.
TEST(CudaFields, ManyTrianglesInOneTile) {
  const Mesh mesh = testing::random_soup(56, 700, 0.6, 0.4);
  const Grid grid{{9, 8, 8}, {-1, -1, -1}, {0.3, 0.3, 0.3}};
  for (const double thickness : {0.5, 1.5, kInfinity}) expect_same(Method::tiles, mesh, grid, thickness);
}

TEST(CudaFields, Scenes) {
  for (const char* name : {"sphere", "labyrinth", "fly"}) {
    SCOPED_TRACE(name);
    const Mesh mesh = scenes::make(name, 300);
    const Grid grid = fit_resolution(bounds(mesh), 20, {.least_samples = 0});
    for (const double thickness : {2 * grid.max_spacing(), kInfinity}) {
      const OrderScope scope(Order::random, 5);
      testing::expect_same_bits(on(Backend::cpu, Method::tiles, mesh, grid, thickness).field,
                                on(testing::kEmulated, Method::tiles, mesh, grid, thickness).field);
    }
  }
}

TEST(CudaFields, IntoDenseMemory) {
  const Mesh mesh = mixed_mesh();
  ComputeOptions options{.sign = {SignMethod::none}};
  std::vector<float> cpu(static_cast<std::size_t>(kCudaGrid.sample_count())), gpu(cpu.size(), -7);
  options.execution.backend = Backend::cpu;
  compute_into(mesh, kCudaGrid, 1, cpu, options);
  options.execution.backend = testing::kEmulated;
  compute_into(mesh, kCudaGrid, 1, gpu, options);
  EXPECT_TRUE(testing::bits_of(cpu) == testing::bits_of(gpu));
}

}  // namespace
}  // namespace standoff
