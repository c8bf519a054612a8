// SPDX-License-Identifier: Apache-2.0
// Meshes that people made, from Debian's glmark2-data and assimp-testmodels, and the same files as assimp sees them.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "standoff/io.h"
#include "tests/support/expect_error.h"

#ifdef STANDOFF_HAVE_ASSIMP
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

namespace standoff {
namespace {

const std::filesystem::path kGlmark = "/usr/share/glmark2/models";
const std::filesystem::path kAssimp = "/usr/share/assimp/models";

void expect_box(const Box& box, const Box& expected, double tolerance) {
  const auto expect_near = [&](Vec3 a, Vec3 b) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
  };
  expect_near(box.min, expected.min);
  expect_near(box.max, expected.max);
}

void expect_mesh(const std::filesystem::path& path, std::size_t vertices, std::size_t triangles, const Box& box) {
  SCOPED_TRACE(path);
  const Mesh mesh = read_mesh(path);
  ASSERT_NO_THROW(validate(mesh));
  EXPECT_EQ(mesh.vertices.size(), vertices);
  EXPECT_EQ(mesh.triangles.size(), triangles);
  expect_box(bounds(mesh), box, 1e-6);
}

TEST(RealFiles, Bunny) {
  expect_mesh(kGlmark / "bunny.obj", 34835, 69666, {{-1, -0.991233, -0.775047}, {1, 0.991233, 0.775047}});
}

TEST(RealFiles, OddOnesOfOurFormats) {
  expect_mesh(kAssimp / "STL/Spider_ascii.stl", 722, 1368, {{-3.114895, -4, -1.649329}, {3.114895, 4, 1.649329}});
  expect_mesh(kAssimp / "STL/3DSMaxExport.STL", 1042, 2000,
              {{-27.3700409, -2.42812181, 9.69857025}, {29.6644974, 45.9131393, 62.342556}});
  expect_mesh(kAssimp / "STL/triangle_with_empty_solid.stl", 3, 1, {{-1, -1, 0}, {1, 1, 0}});
  expect_mesh(kAssimp / "PLY/Wuson.ply", 2117, 3732,
              {{-0.459976, -0.000566, -1.622242}, {0.459976, 1.515251, 1.622242}});
  expect_mesh(kAssimp / "OBJ/concave_polygon.obj", 64, 64, {{-1.146, 1.6575, 1.6055}, {-1.146, 3.1425, 3.0905}});
  expect_mesh(kAssimp / "OFF/Cube.off", 8, 12, {{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}});
}

// Binary, with a file beside it, with its data inside; strips and fans, indexed or not.
TEST(RealFiles, Gltf) {
  const std::filesystem::path folder = kAssimp / "glTF2";
  for (const char* name :
       {"BoxTextured-glTF-Binary/BoxTextured.glb", "BoxTextured-glTF/BoxTextured.gltf",
        "BoxTextured-glTF-Embedded/BoxTextured.gltf", "BoxTextured-glTF-techniqueWebGL/BoxTextured.gltf"})
    expect_mesh(folder / name, 8, 12, {{-.5, -.5, -.5}, {.5, .5, .5}});
  for (const char* number : {"04", "05", "06", "11", "12", "13", "14", "15"})
    expect_mesh(
        folder / ("glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_" + std::string(number) + ".gltf"), 4, 2,
        {{-.5, -.5, 0}, {.5, .5, 0}});
  expect_mesh(folder / "glTF-Sample-Models/AnimatedMorphCube-glTF/AnimatedMorphCube.gltf", 8, 12,
              {{-1, -1, -1}, {1, 1, 1}});
  expect_mesh(folder / "2CylinderEngine-glTF-Binary/2CylinderEngine.glb", 60041, 121496,
              {{-371.692263, -180.971558, -139.999993}, {371.692169, 92.0415617, 127.999996}});
}

#ifdef STANDOFF_HAVE_ASSIMP

// The file's own transformations and master scale are applied; a library that changed its mind would show here.
TEST(RealFiles, ThreeDStudio) {
  expect_mesh(kGlmark / "horse.3ds", 3582, 7172,
              {{-0.626680195, -0.382130504, -0.852197587}, {0.627070665, 0.391027898, 0.851604879}});
  expect_mesh(kGlmark / "asteroid-high.3ds", 24002, 48000,
              {{-1.27560687, -0.884712875, -0.94646275}, {1.15175462, 0.934707046, 0.947464645}});
  expect_mesh(kGlmark / "cat.3ds", 7340, 14348,
              {{-2.23316693, -1.28322458, -1.34113228}, {2.25216746, 1.24490571, 1.35303962}});
  expect_mesh(kAssimp / "3DS/CameraRollAnimWithChildObject.3ds", 16, 24,
              {{-107.233208, -155.746533, -23.0769243}, {45.868947, 38.7464371, 24.7863264}});
}

TEST(RealFiles, Collada) {
  expect_mesh(kAssimp / "Collada/duck.dae", 2108, 4212,
              {{-0.692984985, 0.099293697, -0.613281999}, {0.96179899, 1.63969998, 0.539252002}});
}

struct AssimpView {
  std::size_t triangles = 0;
  Box box;
};

AssimpView as_assimp_sees(const std::filesystem::path& path) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path.string(), aiProcess_ValidateDataStructure | aiProcess_Triangulate);
  AssimpView view;
  if (!scene) return view;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      ++view.triangles;
      for (unsigned c = 0; c < 3; ++c) {
        const aiVector3D& v = mesh.mVertices[face.mIndices[c]];
        view.box.include({v.x, v.y, v.z});
      }
    }
  }
  return view;
}

TEST(RealFiles, AgreeWithAssimp) {
  for (const char* name :
       {"STL/Wuson.stl", "STL/3DSMaxExport.STL", "STL/sphereWithHole.stl", "STL/Spider_binary.stl",
        "STL/Spider_ascii.stl", "PLY/cube_binary.ply", "PLY/cube.ply", "PLY/Wuson.ply", "PLY/float-color.ply",
        "PLY/cube_uv.ply", "OBJ/box.obj", "OBJ/spider.obj", "OBJ/WusonOBJ.obj", "OBJ/cube_with_vertexcolors.obj",
        "OBJ/multiple_spaces.obj", "OBJ/empty_mat.obj", "OBJ/regr_3429812.obj", "OFF/Wuson.off"}) {
    SCOPED_TRACE(name);
    const Mesh mesh = read_mesh(kAssimp / name);
    const AssimpView other = as_assimp_sees(kAssimp / name);
    EXPECT_EQ(mesh.triangles.size(), other.triangles);
    // Assimp keeps floats.
    expect_box(bounds(mesh), other.box, 1e-4);
  }
}

#endif

// Every file of the collection that goes by an extension we know, broken ones included.
TEST(RealFiles, OddAndBrokenOnesGiveAMeshOrAClearError) {
  std::vector<std::string> extensions;
  for (const FileFormat& format : mesh_formats())
    if (format.readable) extensions.push_back("." + format.extension);
  int read = 0, refused = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kAssimp)) {
    std::string extension = entry.path().extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end()) continue;
    SCOPED_TRACE(entry.path());
    try {
      const Mesh mesh = read_mesh(entry.path());
      EXPECT_NO_THROW(validate(mesh));
      ++read;
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_EQ(error.code(), ErrorCode::input) << message;
      EXPECT_TRUE(message.starts_with(entry.path().string() + ":")) << message;
      EXPECT_TRUE(says_what_to_do(message)) << message;
      EXPECT_LT(message.size(), 600u) << message;
      for (const char c : message) EXPECT_TRUE(c >= 0x20 && c < 0x7f) << message;
      ++refused;
    }
  }
  EXPECT_GT(read, 30);
  EXPECT_GT(refused, 10);
}

}  // namespace
}  // namespace standoff
