#include "difi/mesh.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/io/expect_error.h"

namespace difi {
namespace {

const Mesh kMesh{{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}, {9, 9, 9}}, {{0, 1, 2}, {0, 1, 3}}};

TEST(Mesh, ValidateNamesTheTriangle) {
  EXPECT_NO_THROW(validate(kMesh));
  expect_error([] { validate(Mesh{}); }, ErrorCode::input, "no triangles");
  Mesh mesh = kMesh;
  mesh.triangles[1][2] = 5;
  expect_error([&] { validate(mesh); }, ErrorCode::input, "triangle 1: index 5");
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    mesh = kMesh;
    mesh.vertices[3].y = bad;
    expect_error([&] { validate(mesh); }, ErrorCode::input, "triangle 1: vertex 3");
    mesh = kMesh;
    mesh.vertices[4].x = bad;
    EXPECT_NO_THROW(validate(mesh)) << "no triangle uses it";
  }
}

TEST(Mesh, BoundsAreThoseOfUsedVertices) {
  const Box box = bounds(kMesh);
  EXPECT_EQ(box.min, (Vec3{0, 0, 0}));
  EXPECT_EQ(box.max, (Vec3{1, 2, 3}));
  EXPECT_TRUE(bounds(Mesh{}).empty());
}

TEST(Mesh, ContentHashSeesEveryChange) {
  const auto hash = content_hash(kMesh);
  EXPECT_EQ(content_hash(Mesh(kMesh)), hash);
  Mesh mesh = kMesh;
  mesh.vertices[0].z = -0.0;
  EXPECT_NE(content_hash(mesh), hash);
  mesh = kMesh;
  std::swap(mesh.triangles[0], mesh.triangles[1]);
  EXPECT_NE(content_hash(mesh), hash);
  mesh = kMesh;
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_NE(content_hash(mesh), hash);
  mesh = kMesh;
  mesh.triangles.pop_back();
  EXPECT_NE(content_hash(mesh), hash);
}

}  // namespace
}  // namespace difi
