// Files that assimp reads wrongly, or that end the program in it: they must be errors before or after it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>

#include "difi/io.h"
#include "tests/io/expect_error.h"
#include "tests/io/temp_folder.h"

namespace difi {
namespace {

bool reads(const std::string& extension) {
  return std::ranges::any_of(mesh_formats(), [&](const Format& f) { return f.extension == extension && f.readable; });
}

class Assimp : public ::testing::Test {
 protected:
  const TempFolder folder;

  void SetUp() override {
    if (!reads("dae")) GTEST_SKIP() << "this build has no assimp";
  }
  void refused(const std::string& name, const std::string& bytes, const std::string& words) const {
    SCOPED_TRACE(bytes.substr(0, 300));
    const auto path = folder.file(name, bytes);
    expect_error([&] { read_mesh(path); }, ErrorCode::input, words);
  }
  std::size_t triangles(const std::string& name, const std::string& bytes) const {
    return read_mesh(folder.file(name, bytes)).triangles.size();
  }
};

template <class Value>
std::string bytes_of(std::initializer_list<Value> values) {
  return {reinterpret_cast<const char*>(values.begin()), values.size() * sizeof(Value)};
}

std::string chunk(std::uint16_t id, const std::string& content) {
  return bytes_of<std::uint16_t>({id}) + bytes_of({static_cast<std::uint32_t>(6 + content.size())}) + content;
}

// A 3DS of the four corners of a tetrahedron and one face.
std::string tetrahedron(std::uint16_t a, std::uint16_t b, std::uint16_t c) {
  const std::string corners = bytes_of<std::uint16_t>({4}) + bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  const std::string faces = bytes_of<std::uint16_t>({1, a, b, c, 0});
  const std::string mesh = chunk(0x4100, chunk(0x4110, corners) + chunk(0x4120, faces));
  return chunk(0x4d4d, chunk(0x3d3d, chunk(0x4000, std::string("a\0", 2) + mesh)));
}

// Assimp put the last vertex in the place of one that is not there, and said so in its log alone.
TEST_F(Assimp, CornersOf3dsThatAreNoVertices) {
  EXPECT_EQ(triangles("a.3ds", tetrahedron(0, 1, 2)), 1u);
  refused("a.3ds", tetrahedron(0, 1, 60000), "Vertex index overflow");
}

}  // namespace
}  // namespace difi
