// SPDX-License-Identifier: Apache-2.0
// 3DS: chunks, meshes, and the keyframer's nodes that place them.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <initializer_list>
#include <numbers>
#include <thread>

#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/paths.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

class ThreeDStudio : public ::testing::Test {
 protected:
  const TempFolder folder;

  void refused(const std::string& bytes, const std::string& words) const {
    const auto path = folder.file("a.3ds", bytes);
    expect_error([&] { read_mesh(path); }, ErrorCode::input, words);
  }
  Mesh read(const std::string& bytes) const { return read_mesh(folder.file("a.3ds", bytes)).mesh; }
  std::size_t triangles(const std::string& bytes) const { return read(bytes).triangles.size(); }
};

template <class Value>
std::string values_as_bytes(std::initializer_list<Value> values) {
  return {reinterpret_cast<const char*>(values.begin()), values.size() * sizeof(Value)};
}

std::string chunk(std::uint16_t id, const std::string& content) {
  return values_as_bytes<std::uint16_t>({id}) + values_as_bytes({static_cast<std::uint32_t>(6 + content.size())}) +
         content;
}

// A 3DS of the four corners of a tetrahedron and one face.
std::string tetrahedron(std::uint16_t a, std::uint16_t b, std::uint16_t c) {
  const std::string corners =
      values_as_bytes<std::uint16_t>({4}) + values_as_bytes<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  const std::string faces = values_as_bytes<std::uint16_t>({1, a, b, c, 0});
  const std::string mesh = chunk(0x4100, chunk(0x4110, corners) + chunk(0x4120, faces));
  return chunk(0x4d4d, chunk(0x3d3d, chunk(0x4000, std::string("a\0", 2) + mesh)));
}

// The tetrahedron with nodes of these kinds, names and parents.
std::string with_nodes(const std::string& nodes) {
  std::string file = tetrahedron(0, 1, 2) + chunk(0xb000, nodes);
  const auto size = static_cast<std::uint32_t>(file.size());
  std::memcpy(file.data() + 2, &size, sizeof size);
  return file;
}

std::string node(const std::string& name, int parent, std::uint16_t kind = 0xb002) {
  return chunk(kind, chunk(0xb010, name + std::string(5, '\0') + values_as_bytes({static_cast<std::int16_t>(parent)})));
}

std::string object(const std::string& name, const std::string& parts) { return chunk(0x4000, name + '\0' + parts); }

std::string repeated(int times, const std::string& part) {
  std::string all;
  all.reserve(static_cast<std::size_t>(times) * part.size());
  for (int n = 0; n < times; ++n) all += part;
  return all;
}

void expect_vertices(const Mesh& mesh, std::initializer_list<Vec3> expected) {
  ASSERT_EQ(mesh.vertices.size(), expected.size());
  for (std::size_t v = 0; v < expected.size(); ++v) {
    const Vec3 wanted = expected.begin()[v];
    EXPECT_LT(max_norm(mesh.vertices[v] - wanted), 1e-7)
        << v << ": " << mesh.vertices[v].x << " " << mesh.vertices[v].y << " " << mesh.vertices[v].z;
  }
}

// A track of one key.
std::string track(std::uint16_t id, std::initializer_list<float> values, std::uint32_t frame = 0) {
  return chunk(id, std::string(10, '\0') + values_as_bytes<std::uint32_t>({1, frame}) +
                       values_as_bytes<std::uint16_t>({0}) + values_as_bytes(values));
}

// The name of a node above others, with tracks.
std::string node_with(const std::string& name, const std::string& tracks, int parent = -1,
                      std::uint16_t kind = 0xb002) {
  return chunk(
      kind, chunk(0xb010, name + std::string(5, '\0') + values_as_bytes({static_cast<std::int16_t>(parent)})) + tracks);
}

// From z up to y up: (x, y, z) becomes (x, z, -y).
TEST_F(ThreeDStudio, AxesAndScale) {
  expect_vertices(read(tetrahedron(0, 1, 2)), {{0, 0, 0}, {1, 0, 0}, {0, 0, -1}});
  const std::string file = tetrahedron(0, 1, 2), scale = chunk(0x0100, values_as_bytes({4.0f}));
  const auto path = folder.file("a.3ds", chunk(0x4d4d, chunk(0x3d3d, scale + file.substr(12))));
  const auto [mesh, report] = read_mesh(path);
  expect_vertices(mesh, {{0, 0, 0}, {0.25, 0, 0}, {0, 0, -0.25}});
  EXPECT_EQ(report.axes, (std::array<int, 3>{1, 3, -2}));
  EXPECT_EQ(report.unit_scale, 0.25);
}

TEST_F(ThreeDStudio, NodesMoveScaleAndTurn) {
  expect_vertices(read(with_nodes(node_with("a", track(0xb020, {1, 2, 3})))), {{1, 3, -2}, {2, 3, -2}, {1, 3, -3}});
  expect_vertices(read(with_nodes(node_with("a", track(0xb022, {2, 3, 0})))), {{0, 0, 0}, {2, 0, 0}, {0, 0, -3}});
  // Clockwise about z: x becomes -y, y becomes x.
  const auto quarter = static_cast<float>(std::numbers::pi / 2);
  expect_vertices(read(with_nodes(node_with("a", track(0xb021, {quarter, 0, 0, 2})))),
                  {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}});
  // The pivot becomes the origin before all that.
  const std::string pivot = chunk(0xb013, values_as_bytes({1.0f, 0.0f, 0.0f}));
  expect_vertices(read(with_nodes(node_with("a", pivot + track(0xb022, {2, 2, 2})))),
                  {{-2, 0, 0}, {0, 0, 0}, {-2, 0, -2}});
  // Below another node, the key of the earliest frame, and about a camera's axis.
  const std::string keys = track(0xb020, {9, 9, 9}, 7) + track(0xb020, {1, 0, 0}, 3);
  expect_vertices(read(with_nodes(node_with("b", track(0xb020, {0, 0, 5})) + node_with("a", keys, 0))),
                  {{1, 5, 0}, {2, 5, 0}, {1, 5, -1}});
  expect_vertices(read(with_nodes(node_with("c", track(0xb024, {90}), -1, 0xb003) + node_with("a", "", 0))),
                  {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}});
  // Meshes that no node names are left out.
  refused(with_nodes(node_with("b", "")), "the file holds no triangles");
}

// A mesh is saved where it stands: its matrix says from where, and a mirroring one was mirrored in x before.
TEST_F(ThreeDStudio, MatricesAreUndone) {
  const auto placed = [](std::initializer_list<float> matrix) {
    const std::string corners =
                          values_as_bytes<std::uint16_t>({3}) + values_as_bytes<float>({0, 0, 0, 2, 0, 0, 0, 1, 0}),
                      faces = values_as_bytes<std::uint16_t>({1, 0, 1, 2, 0});
    const std::string mesh =
        chunk(0x4100, chunk(0x4110, corners) + chunk(0x4120, faces) + chunk(0x4160, values_as_bytes(matrix)));
    return chunk(0x4d4d, chunk(0x3d3d, object("a", mesh)) + chunk(0xb000, node("a", -1)));
  };
  expect_vertices(read(placed({2, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 3})), {{-0.5, -3, 0}, {0.5, -3, 0}, {-0.5, -3, -1}});
  expect_vertices(read(placed({-2, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0})), {{0, 0, 0}, {1, 0, 0}, {0, 0, -1}});
  refused(placed({1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0}), ":mesh 'a': its matrix has no inverse");
}

// Chains of 60,000 nodes ended the stack, or took minutes, when assimp read them.
TEST_F(ThreeDStudio, NodesMayBeNestedDeeply) {
  std::string chain, cameras, siblings, many;
  for (int n = 0; n < 20'000; ++n) {
    chain += node("a", n - 1);
    cameras += node("c" + std::to_string(n), n - 1, 0xb003);
    siblings += node("a", -1);
  }
  EXPECT_EQ(triangles(with_nodes(chain)), 20'000u);
  EXPECT_EQ(triangles(with_nodes(cameras + node("a", -1))), 1u);
  EXPECT_EQ(triangles(with_nodes(siblings)), 20'000u);
  EXPECT_EQ(triangles(with_nodes(node("a", -1) + node("b", 0) + node("a", 1))), 2u);
  for (int n = 0; n < 100'001; ++n) many += node("", -1);
  refused(with_nodes(many), "more than 100000 nodes in its keyframes; write the file again without");
}

// As many nodes of a name as meshes of it: each places all.
TEST_F(ThreeDStudio, NodesThatUnfoldTooFar) {
  const std::string mesh = tetrahedron(0, 1, 2).substr(12);
  const std::string file =
      chunk(0x4d4d, chunk(0x3d3d, repeated(5000, mesh)) + chunk(0xb000, repeated(5000, node("a", -1))));
  const auto path = folder.file("a.3ds", file);
  expect_error([&] { read_mesh(path); }, ErrorCode::limit, "its nodes place meshes until they have 75000000 vertices");
}

// Assimp put the last vertex in the place of one that is not there.
TEST_F(ThreeDStudio, CornersThatAreNoVertices) {
  EXPECT_EQ(triangles(tetrahedron(0, 1, 2)), 1u);
  refused(tetrahedron(0, 1, 60000), ":mesh 'a' face 0: vertex index 60000 is out of range, there are 4 vertices");
  const std::string faces = chunk(0x4120, values_as_bytes<std::uint16_t>({1, 0, 0, 0, 0}));
  refused(chunk(0x4d4d, chunk(0x3d3d, object("a", chunk(0x4100, faces)))), "there are 0 vertices");
  refused(chunk(0x4d4d, chunk(0x3d3d, object("a", chunk(0x4100, "")))), "the file holds no triangles");
}

// What is not looked at may be as it likes: each of these took memory or time in assimp.
TEST_F(ThreeDStudio, MaterialsAndLightsDoNotMatter) {
  const auto with = [](const std::string& more) {
    const std::string file = tetrahedron(0, 1, 2);
    return chunk(0x4d4d, chunk(0x3d3d, file.substr(12) + more));
  };
  const std::string material = chunk(0xafff, "x"), light = chunk(0x4600, std::string(12, '\0'));
  EXPECT_EQ(triangles(with(repeated(50'000, material))), 1u);
  EXPECT_EQ(triangles(with(repeated(10'000, object("b", light)))), 1u);
  EXPECT_EQ(triangles(with(repeated(30'000, object("b", chunk(0x4100, ""))))), 1u);
  const std::string group = chunk(0x4130, std::string("m\0\0\0", 4)),
                    face = values_as_bytes<std::uint16_t>({1, 0, 0, 0, 0}),
                    corner = chunk(0x4110, values_as_bytes<std::uint16_t>({1}) + std::string(12, '\0'));
  EXPECT_EQ(triangles(with(object("b", chunk(0x4100, corner + chunk(0x4120, face + repeated(100'001, group)))))), 2u);
}

TEST_F(ThreeDStudio, ChunksDoNotReachIntoEachOther) {
  std::string longer = object("a", chunk(0x4100, "123456") + chunk(0x4111, ""));
  const std::uint32_t size = 60;
  std::memcpy(longer.data() + 10, &size, sizeof size);
  refused(chunk(0x4d4d, chunk(0x3d3d, repeated(2000, longer))), "chunks, which reach into each other");
}

TEST_F(ThreeDStudio, CutOff) {
  const std::string whole = with_nodes(node_with("a", track(0xb021, {1, 0, 0, 1})));
  ASSERT_EQ(triangles(whole), 1u);
  for (std::size_t size = 1; size < whole.size(); ++size) refused(whole.substr(0, size), "a.3ds:");
  // The chunk around is whole, the list in it is not.
  const std::string corners = values_as_bytes<std::uint16_t>({4}) + std::string(40, '\0');
  refused(chunk(0x4d4d, chunk(0x3d3d, object("a", chunk(0x4100, chunk(0x4110, corners))))),
          "a chunk ends 8 bytes too early; the file is cut off or damaged, get all of it");
  refused(chunk(0x4d4d, chunk(0x3d3d, chunk(0x4000, "a"))), "a name without an end");
  refused(values_as_bytes<std::uint16_t>({0x4d4d}) + values_as_bytes<std::uint32_t>({3}) + "123", "a chunk of 3 bytes");
}

// Found by fuzzing: a track that claims 4 thousand million keys.
TEST_F(ThreeDStudio, TracksHaveTheKeysTheyClaim) {
  const auto animated = [](std::uint16_t track, std::uint32_t keys, std::size_t bytes) {
    const std::string name = chunk(0xb010, std::string("a\0", 2) + values_as_bytes<std::uint16_t>({0, 0, 0xffff}));
    const std::string content = std::string(10, '\0') + values_as_bytes({keys}) + std::string(bytes, '\0');
    const std::string node =
        chunk(0xb002, chunk(0xb030, values_as_bytes<std::uint16_t>({0})) + name + chunk(track, content));
    std::string file = tetrahedron(0, 1, 2) + chunk(0xb000, node);
    const auto size = static_cast<std::uint32_t>(file.size());
    std::memcpy(file.data() + 2, &size, sizeof size);
    return file;
  };
  EXPECT_EQ(triangles(animated(0xb020, 2, 36)), 1u);
  EXPECT_EQ(triangles(animated(0xb020, 0, 0)), 1u);
  for (const std::uint16_t track :
       {std::uint16_t{0xb020}, std::uint16_t{0xb021}, std::uint16_t{0xb022}, std::uint16_t{0xb029}}) {
    refused(animated(track, 0xfffffff0, 36), "a track of 4294967280 keys, where 36 bytes are left");
    refused(animated(track, 7, 36), "a track of 7 keys, where 36 bytes are left; the file is cut off");
  }
}

// The bytes that were checked are those that are read: a pipe has them once.
TEST_F(ThreeDStudio, ReadsPipes) {
  ASSERT_EQ(::mkfifo((folder / "pipe.3ds").c_str(), 0600), 0);
  std::thread writer([&] { write_bytes(folder / "pipe.3ds", tetrahedron(0, 1, 2)); });
  EXPECT_EQ(read_mesh(folder / "pipe.3ds").mesh.triangles.size(), 1u);
  writer.join();
}

std::string packed(const std::string& bytes) {
  const TempFolder folder;
  const gzFile file = ::gzopen((folder / "packed").c_str(), "wb");
  ::gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
  ::gzclose(file);
  return read_bytes(folder / "packed");
}

TEST_F(ThreeDStudio, PackedFilesAreReadToo) {
  EXPECT_EQ(read_mesh(folder.file("a.3ds.gz", packed(tetrahedron(0, 1, 2)))).mesh.triangles.size(), 1u);
}

TEST_F(ThreeDStudio, ReadsTheSeedOfTheFuzzer) {
  const Mesh mesh = read_mesh(std::filesystem::path(kSourceFolder) / "tests/corpus/scene/tetrahedron.3ds").mesh;
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(mesh.vertices.size(), 4u);
}

}  // namespace
}  // namespace standoff
