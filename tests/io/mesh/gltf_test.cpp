// SPDX-License-Identifier: Apache-2.0
// glTF: every way to write the same triangles gives the same triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "standoff/io.h"
#include "tests/io/mesh/gltf_document.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

using Corners = std::array<Vec3, 3>;

std::vector<Corners> triangles_of(const Mesh& mesh) {
  std::vector<Corners> triangles;
  for (const Triangle& t : mesh.triangles)
    triangles.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  return triangles;
}

std::vector<Corners> read(const GltfDocument& document) {
  const TempFolder folder;
  SCOPED_TRACE(document.text());
  const auto text = triangles_of(read_mesh(folder.file("a.gltf", document.text())).mesh);
  EXPECT_EQ(triangles_of(read_mesh(folder.file("a.glb", document.binary())).mesh), text);
  return text;
}

const Vec3 kO{0, 0, 0}, kX{1, 0, 0}, kY{0, 1, 0};
const std::vector<Corners> kOne{{kO, kX, kY}};

TEST(Gltf, OneTriangle) {
  EXPECT_EQ(read({}), kOne);
  EXPECT_EQ(read({.nodes = R"([{"m\u0065sh":0}])"}), kOne);  // a name with an escape is the same name
  EXPECT_EQ(read({.uri = "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}), kOne);
  EXPECT_EQ(read({.uri = "DATA:a\\/b;BASE64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}), kOne);
  const TempFolder folder;
  EXPECT_EQ(triangles_of(read_mesh(folder.file("a.gltf", "\xef\xbb\xbf" + GltfDocument().text() + "\n")).mesh), kOne);
}

TEST(Gltf, IndicesOfEveryType) {
  const std::string positions = GltfDocument().data;
  const auto indexed = [&](const std::string& type, const std::string& indices) {
    return read({.primitive = R"({"attributes":{"POSITION":0},"indices":1})",
                 .accessors = GltfDocument().accessors + R"(,{"bufferView":1,"componentType":)" + type +
                              R"(,"count":3,"type":"SCALAR"})",
                 .views = GltfDocument().views + R"(,{"buffer":0,"byteOffset":36,"byteLength":)" +
                          std::to_string(indices.size()) + "}",
                 .data = positions + indices});
  };
  const std::vector<Corners> turned{{kY, kO, kX}};
  EXPECT_EQ(indexed("5121", little_endian<std::uint8_t>({2, 0, 1})), turned);
  EXPECT_EQ(indexed("5123", little_endian<std::uint16_t>({2, 0, 1})), turned);
  EXPECT_EQ(indexed("5125", little_endian<std::uint32_t>({2, 0, 1})), turned);
}

// Positions among other attributes, and after a gap: strides and offsets of view and accessor.
TEST(Gltf, InterleavedPositions) {
  const float n = 77;
  EXPECT_EQ(read({.accessors = R"({"bufferView":0,"byteOffset":4,"componentType":5126,"count":3,"type":"VEC3"})",
                  .views = R"({"buffer":0,"byteOffset":8,"byteLength":56,"byteStride":20})",
                  .data = little_endian<float>({n, n, n, 0, 0, 0, n, n, 1, 0, 0, n, n, 0, 1, 0})}),
            kOne);
}

// The specification's example of a sparse accessor, and one over zeros.
TEST(Gltf, SparsePositions) {
  const std::string views = R"({"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":4},)"
                            R"({"buffer":0,"byteOffset":40,"byteLength":24})";
  const std::string sparse = R"("componentType":5126,"count":3,"type":"VEC3","sparse":{"count":2,)"
                             R"("indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":2}}})";
  const std::string replaced = little_endian<std::uint16_t>({1, 2}) + little_endian<float>({1, 0, 0, 0, 1, 0});
  EXPECT_EQ(read({.accessors = R"({"bufferView":0,)" + sparse,
                  .views = views,
                  .data = little_endian<float>({0, 0, 0, 9, 9, 9, 8, 8, 8}) + replaced}),
            kOne);
  EXPECT_EQ(read({.accessors = "{" + sparse, .views = views, .data = std::string(36, '\7') + replaced}), kOne);
}

// KHR_mesh_quantization: integers as they are, or as shares of the largest one; -128 and -127 are both -1.
TEST(Gltf, QuantizedPositions) {
  const auto quantized = [](const std::string& type, bool normalized, const std::string& data) {
    return read({.accessors = R"({"bufferView":0,"componentType":)" + type +
                              R"(,"count":3,"type":"VEC3","normalized":)" + (normalized ? "true}" : "false}"),
                 .views = R"({"buffer":0,"byteLength":)" + std::to_string(data.size()) + R"(,"byteStride":)" +
                          std::to_string(data.size() / 3) + "}",
                 .data = data,
                 .root = R"(,"extensionsRequired":["KHR_mesh_quantization"])"});
  };
  EXPECT_EQ(quantized("5122", false, little_endian<std::int16_t>({0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0, 9})), kOne);
  EXPECT_EQ(quantized("5123", true, little_endian<std::uint16_t>({0, 0, 0, 9, 65535, 0, 0, 9, 0, 65535, 0, 9})), kOne);
  EXPECT_EQ(quantized("5121", true, little_endian<std::uint8_t>({0, 0, 0, 9, 255, 0, 0, 9, 0, 255, 0, 9})), kOne);
  const std::vector<Corners> below{{Vec3{-1, -1, 0}, kX, kY}};
  EXPECT_EQ(quantized("5120", true, little_endian<std::int8_t>({-128, -127, 0, 9, 127, 0, 0, 9, 0, 127, 0, 9})), below);
  const std::vector<Corners> large{{Vec3{-32768, 0, 32767}, kX, kY}};
  EXPECT_EQ(quantized("5122", false, little_endian<std::int16_t>({-32768, 0, 32767, 9, 1, 0, 0, 9, 0, 1, 0, 9})),
            large);
}

// In the order of the specification; all triangles of a strip look the same way.
TEST(Gltf, StripsAndFans) {
  const auto five = [](const std::string& mode) {
    return read({.primitive = R"({"attributes":{"POSITION":0},"mode":)" + mode + "}",
                 .accessors = R"({"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"})",
                 .views = R"({"buffer":0,"byteLength":60})",
                 .data = little_endian<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0})});
  };
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{1, 1, 0}, e{0, 2, 0};
  EXPECT_EQ(five("5"), (std::vector<Corners>{{a, b, c}, {b, d, c}, {c, d, e}}));
  EXPECT_EQ(five("6"), (std::vector<Corners>{{b, c, a}, {c, d, a}, {d, e, a}}));
}

// Lines have no surface: whatever they are, they are no reason to refuse the triangles beside them.
TEST(Gltf, LinesArePassedOver) {
  const std::string surface = GltfDocument().primitive;
  for (const char* mode : {"0", "1", "2", "3"})
    EXPECT_EQ(
        read({.primitive = R"({"attributes":{"POSITION":0},"indices":0,"mode":)" + std::string(mode) + "}," + surface}),
        kOne);
}

TEST(Gltf, PrimitivesShareTheirVertices) {
  const TempFolder folder;
  GltfDocument document;
  document.primitive += "," + document.primitive;
  const Mesh mesh = read_mesh(folder.file("a.gltf", document.text())).mesh;
  EXPECT_EQ(mesh.vertices.size(), 3u);
  EXPECT_EQ(mesh.triangles.size(), 2u);
}

TEST(Gltf, NodesPlaceTheirMeshes) {
  // First scaled, then turned, then shifted; the parent's after the child's.
  const std::string node = R"({"mesh":0,"translation":[10,0,0],"rotation":[0,0,0.7071068,0.7071068],"scale":[2,3,1]})";
  const auto near = [](const std::vector<Corners>& found, const Corners& expected) {
    ASSERT_EQ(found.size(), 1u);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_LT(length(found[0][c] - expected[c]), 1e-14 * 10);
  };
  near(read({.nodes = "[" + node + "]"}), {Vec3{10, 0, 0}, Vec3{10, 2, 0}, Vec3{7, 0, 0}});
  near(read({.nodes = R"([{"scale":[1,2,1],"children":[1]},)" + node + "]"}),
       {Vec3{10, 0, 0}, Vec3{10, 4, 0}, Vec3{7, 0, 0}});
  // Column by column.
  EXPECT_EQ(read({.nodes = R"([{"mesh":0,"matrix":[0,1,0,0, 0,0,1,0, 1,0,0,0, 5,6,7,1]}])"}),
            (std::vector<Corners>{{Vec3{5, 6, 7}, Vec3{5, 7, 7}, Vec3{5, 6, 8}}}));
  // A number too small for a double, also without an exponent, is zero.
  EXPECT_EQ(read({.nodes = R"([{"mesh":0,"translation":[0.)" + std::string(400, '0') + "1,-1e-400,3]}]"}),
            (std::vector<Corners>{{Vec3{0, 0, 3}, Vec3{1, 0, 3}, Vec3{0, 1, 3}}}));
  // The same mesh twice, in the order of the tree.
  EXPECT_EQ(read({.nodes = R"([{"children":[2,1]},{"mesh":0},{"mesh":0,"translation":[0,0,1]}])"}),
            (std::vector<Corners>{{Vec3{0, 0, 1}, Vec3{1, 0, 1}, Vec3{0, 1, 1}}, kOne[0]}));
}

// The corners of a mirrored node turn the other way round, so that its outside stays outside.
TEST(Gltf, MirroredNodes) {
  EXPECT_EQ(read({.nodes = R"([{"mesh":0,"scale":[-1,1,1]}])"}), (std::vector<Corners>{{kO, kY, Vec3{-1, 0, 0}}}));
  EXPECT_EQ(read({.nodes = R"([{"mesh":0,"scale":[-1,-1,1]}])"}),
            (std::vector<Corners>{{kO, Vec3{-1, 0, 0}, Vec3{0, -1, 0}}}));
}

// It ended the stack of assimp.
TEST(Gltf, AChainOfNodesMayBeLong) {
  constexpr int kLong = 25'000;
  std::string nodes = "[";
  for (int n = 1; n < kLong; ++n) nodes += R"({"translation":[0,0,1],"children":[)" + std::to_string(n) + "]},";
  EXPECT_EQ(read({.nodes = nodes + R"({"mesh":0}])"}),
            (std::vector<Corners>{{Vec3{0, 0, kLong - 1}, Vec3{1, 0, kLong - 1}, Vec3{0, 1, kLong - 1}}}));
}

TEST(Gltf, TheSceneThatIsNamed) {
  GltfDocument document{.nodes = R"([{"mesh":0},{"mesh":0,"translation":[0,0,1]}])", .scene = R"([0]},{"nodes":[1])"};
  EXPECT_EQ(read(document), kOne);
  const TempFolder folder;
  std::string text = document.text();
  text.replace(text.find(R"("scene":0)"), 9, R"("scene":1)");
  EXPECT_EQ(read_mesh(folder.file("a.gltf", text)).mesh.vertices[0], (Vec3{0, 0, 1}));
}

// Skins, animations and materials change nothing of what is read; what they refer to need not be there.
TEST(Gltf, WhatIsNoShapeIsLeftOut) {
  EXPECT_EQ(
      read({.nodes = R"([{"mesh":0,"skin":7,"camera":9},{}])",
            .root = R"(,"skins":[{"joints":[1]}],"animations":[{}],"images":[{"uri":"../none.png"},)"
                    R"({"uri":"file:///dev/zero","mimeType":"png"}],"materials":7,)"
                    R"("extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_texture_basisu"])"}),
      kOne);
}

}  // namespace
}  // namespace standoff
