// SPDX-License-Identifier: Apache-2.0
#include "standoff/mesh.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <algorithm>
#include <limits>
#include <set>

#include "tests/support/expect_error.h"

namespace standoff {
namespace {

const Mesh kSquare{{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}, {9, 9, 9}}, {{0, 1, 2}, {0, 1, 3}}};

TEST(Mesh, ValidateNamesTheTriangle) {
  EXPECT_NO_THROW(validate(kSquare));
  expect_error([] { validate(Mesh{}); }, ErrorCode::input, "no triangles");
  Mesh mesh = kSquare;
  mesh.triangles[1][2] = 5;
  expect_error([&] { validate(mesh); }, ErrorCode::input, "triangle 1: index 5");
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    mesh = kSquare;
    mesh.vertices[3].y = bad;
    expect_error([&] { validate(mesh); }, ErrorCode::input, "triangle 1: vertex 3");
    mesh = kSquare;
    mesh.vertices[4].x = bad;
    EXPECT_NO_THROW(validate(mesh)) << "no triangle uses it";
  }
}

// Lengths alone decide: the memory behind them is reserved and cannot be read.
TEST(Mesh, ValidateRefusesWhatIndicesCannotCount) {
  const std::size_t vertices = std::size_t{1} << 32, triangles = 4'000'000'001;
  const std::size_t bytes = std::max(vertices * sizeof(Vec3), triangles * sizeof(Triangle));
  void* reserved = ::mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (reserved == MAP_FAILED) GTEST_SKIP() << "no " << bytes << " bytes of addresses";
  MeshView mesh = kSquare;
  mesh.vertices = std::span(static_cast<const Vec3*>(reserved), vertices);
  expect_error([&] { validate(mesh); }, ErrorCode::limit, "2 triangles over 4294967296 vertices are more than");
  mesh = kSquare;
  mesh.triangles = std::span(static_cast<const Triangle*>(reserved), triangles);
  expect_error([&] { validate(mesh); }, ErrorCode::limit, "4000000001 triangles over 5 vertices are more than");
  ::munmap(reserved, bytes);
}

TEST(Mesh, BoundsAreThoseOfUsedVertices) {
  const Box box = bounds(kSquare);
  EXPECT_EQ(box.min, (Vec3{0, 0, 0}));
  EXPECT_EQ(box.max, (Vec3{1, 2, 3}));
  EXPECT_TRUE(bounds(Mesh{}).empty());
}

// A pyramid without its floor's twin: the floor is the only side that lies flat.
Mesh pyramid(Axis up, double size = 1) {
  Mesh mesh{{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 3}}, {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}}};
  for (Vec3& v : mesh.vertices) {
    const Vec3 p = v * size;
    v = up == Axis::x ? Vec3{p.z, p.x, p.y} : up == Axis::y ? Vec3{p.y, p.z, p.x} : p;
  }
  return mesh;
}

TEST(Mesh, StandsOnItsFlattestBase) {
  for (const Axis up : {Axis::x, Axis::y, Axis::z})
    for (const double size : {1e-300, 1.0, 1e200}) EXPECT_EQ(up_axis(pyramid(up, size)), up) << size;
  Mesh ball = pyramid(Axis::y);
  ball.triangles.erase(ball.triangles.begin(), ball.triangles.begin() + 2);
  EXPECT_EQ(up_axis(ball), Axis::z) << "no side is flat";
  EXPECT_EQ(up_axis(Mesh{}), Axis::z);
  expect_error([] { up_axis(Mesh{{{0, 0, 0}}, {{0, 1, 2}}}); }, ErrorCode::input, "out of range");
}

TEST(Mesh, ContentHashSeesEveryChange) {
  const auto hash = content_hash(kSquare);
  EXPECT_EQ(content_hash(Mesh(kSquare)), hash);
  Mesh mesh = kSquare;
  mesh.vertices[0].z = -0.0;
  EXPECT_NE(content_hash(mesh), hash);
  mesh = kSquare;
  std::swap(mesh.triangles[0], mesh.triangles[1]);
  EXPECT_NE(content_hash(mesh), hash);
  mesh = kSquare;
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_NE(content_hash(mesh), hash);
  mesh = kSquare;
  mesh.triangles.pop_back();
  EXPECT_NE(content_hash(mesh), hash);
}

// Hashing goes in chains side by side: every place counts in each of them, and its order with the others.
TEST(Mesh, ContentHashSeesEveryPlace) {
  Mesh mesh;
  for (std::uint32_t n = 0; n < 30; ++n) {
    mesh.vertices.push_back({double(n), 0.5 * n, -1.0 * n});
    mesh.triangles.push_back({n, (n + 1) % 30, (n + 2) % 30});
  }
  std::set<std::uint64_t> hashes{content_hash(mesh)};
  std::size_t changes = 1;
  const auto expect_new = [&](const Mesh& changed) {
    hashes.insert(content_hash(changed));
    EXPECT_EQ(hashes.size(), ++changes);
  };
  for (std::size_t n = 0; n < 30; ++n) {
    for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      Mesh changed = mesh;
      changed.vertices[n].*axis += 100;
      expect_new(changed);
    }
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Mesh changed = mesh;
      changed.triangles[n][corner] += 100;
      expect_new(changed);
    }
    if (n + 8 >= 30) continue;
    Mesh changed = mesh;
    std::swap(changed.triangles[n], changed.triangles[n + 8]);
    expect_new(changed);
    changed = mesh;
    std::swap(changed.vertices[n], changed.vertices[n + 8]);
    expect_new(changed);
  }
}

}  // namespace
}  // namespace standoff
