// SPDX-License-Identifier: Apache-2.0
// Meshes that people made, from Debian's glmark2-data and assimp-testmodels, and what assimp 5.2.5 made of them.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "standoff/io.h"
#include "tests/support/expect_error.h"

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
  const Mesh mesh = read_mesh(path).mesh;
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

// Made once from what assimp 5.2.5 read, which kept coordinates as floats; area and volume as our sums of its
// triangles.
struct ReadByAssimp {
  std::filesystem::path path;
  std::size_t vertices, triangles;
  Box box;
  double area, volume;
};
const ReadByAssimp kReadByAssimp[] = {
    // clang-format off
    {kAssimp / "STL/Wuson.stl", 2117, 3732, {{-0.459975988, -0.000566000002, -1.62224197}, {0.459975988, 1.51525104, 1.62224197}}, 9.02580394, 1.1012913},
    {kAssimp / "STL/3DSMaxExport.STL", 1042, 2000, {{-27.3700409, -2.42812181, 9.69857025}, {29.6644974, 45.9131393, 62.342556}}, 1734.41573, 993.15193},
    {kAssimp / "STL/sphereWithHole.stl", 146, 285, {{0, 0, 0}, {3, 3, 3}}, 27.418721, 13.6032452},
    {kAssimp / "STL/Spider_binary.stl", 722, 1368, {{-3.11489487, -4, -1.64932859}, {3.11489487, 4, 1.64932859}}, 56.9475827, 10.0918781},
    {kAssimp / "STL/Spider_ascii.stl", 722, 1368, {{-3.114895, -4, -1.649329}, {3.114895, 4, 1.649329}}, 56.9475806, 10.0918789},
    {kAssimp / "PLY/cube_binary.ply", 8, 12, {{0, 0, 0}, {1, 1, 1}}, 6, 1},
    {kAssimp / "PLY/cube.ply", 8, 12, {{0, 0, 0}, {1, 1, 1}}, 6, 1},
    {kAssimp / "PLY/Wuson.ply", 2117, 3732, {{-0.459975988, -0.000566000002, -1.62224197}, {0.459975988, 1.51525104, 1.62224197}}, 9.02580394, 1.1012913},
    {kAssimp / "PLY/float-color.ply", 3, 1, {{0, 0, 0}, {200, 200, 0}}, 10000, 0},
    {kAssimp / "PLY/cube_uv.ply", 8, 12, {{-1, -1.00000095, -1}, {1, 1, 1}}, 23.9999979, 7.99999793},
    {kAssimp / "OBJ/box.obj", 8, 12, {{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}}, 6, 1},
    {kAssimp / "OBJ/spider.obj", 722, 1368, {{-92.655235, -42.233826, -106.6912}, {57.936218, 37.503952, 86.6912}}, 33275.8521, 142545.276},
    {kAssimp / "OBJ/WusonOBJ.obj", 2117, 3732, {{-0.459976, -0.000566, -1.622242}, {0.459976, 1.515251, 1.622242}}, 9.02580391, 1.10129131},
    {kAssimp / "OBJ/cube_with_vertexcolors.obj", 8, 12, {{0, 0, 0}, {1, 1, 1}}, 6, 1},
    {kAssimp / "OBJ/multiple_spaces.obj", 3, 1, {{1, 1, 1}, {3, 3, 3}}, 2.59807621, -1.5},
    {kAssimp / "OBJ/empty_mat.obj", 130, 256, {{-1, -1, -1}, {1, 2.802455, 1}}, 21.7672106, 5.85482355},
    {kAssimp / "OBJ/regr_3429812.obj", 4, 4, {{0.0418548, 0.961535, 0.0939126}, {0.0498759, 0.964456, 0.0980526}}, 2.35962494e-05, -7.7256604e-09},
    {kAssimp / "OFF/Wuson.off", 2117, 3732, {{-0.459976, -0.000566, -1.622242}, {0.459976, 1.515251, 1.622242}}, 9.02580391, -1.10129131},
    {kAssimp / "3DS/CameraRollAnim.3ds", 8, 12, {{-24.7863264, 0, -23.0769243}, {45.868947, 38.7464371, 24.7863264}}, 15947.9232, 131032.355},
    {kAssimp / "3DS/CameraRollAnimWithChildObject.3ds", 16, 24, {{-107.233208, -155.746533, -23.0769243}, {45.868947, 38.7464371, 24.7863264}}, 30058.8541, 226937.221},
    {kAssimp / "3DS/RotatingCube.3DS", 8, 12, {{-29.3447247, -4.08617844, -29.2584642}, {37.3219318, 49.2082692, 34.1813246}}, 18997.8911, 174890.266},
    {kAssimp / "3DS/TargetCameraAnim.3ds", 8, 12, {{-24.7863264, 0, -23.0769243}, {45.868947, 38.7464371, 24.7863264}}, 15947.9232, 131032.355},
    {kAssimp / "3DS/cube_with_diffuse_texture.3DS", 8, 12, {{-50.0000034, -30.5401626, -82.6177381}, {8.47901538e-06, 19.4598374, -32.6177292}}, 15000, 125000},
    {kAssimp / "3DS/cube_with_specular_texture.3DS", 8, 12, {{-50.0000034, -30.5401626, -82.6177381}, {8.47901538e-06, 19.4598374, -32.6177292}}, 15000, 125000},
    {kAssimp / "3DS/cubes_with_alpha.3DS", 40, 60, {{-856.310974, -268.159119, -1227.14087}, {98.8104987, 248.437958, 55.1008835}}, 3300000.11, 225000011},
    {kAssimp / "3DS/fels.3ds", 386, 768, {{-2.22191334, -2.56474113, -0.121266291}, {1.28288484, 2.11685991, 3.08428526}}, 60.1667153, 37.2147133},
    {kAssimp / "3DS/test1.3ds", 72, 108, {{-10.3432089, -10.1550746, -10.2302727}, {9.85085175, 10.2475825, 0.194162658}}, 3453.47844, 501.433314},
    {kAssimp / "Collada/COLLADA.dae", 3370, 6722, {{-3.99999991, 0, -1.99999996}, {3.99999991, 1.08097997, 1.99999996}}, 63.9230774, 1.69023937},
    {kAssimp / "Collada/COLLADA_triangulate.dae", 3370, 6722, {{-3.99999991, 0, -1.99999996}, {3.99999991, 1.08097997, 1.99999996}}, 63.9230772, 1.69023937},
    {kAssimp / "Collada/Cinema4D.dae", 671, 1296, {{-100, -100, -100}, {314.018997, 100, 310.630005}}, 465245.419, 14154539.1},
    {kAssimp / "Collada/ConcavePolygon.dae", 64, 64, {{-1.14600003, 1.65750003, 1.60549998}, {-1.14600003, 3.14249992, 3.09049988}}, 0.245496643, 0},
    {kAssimp / "Collada/anims_with_full_rotations_between_keys.DAE", 512, 768, {{-0.315605061, 0, -119.684557}, {0.685947027, 1, 0.500000016}}, 384, 64},
    {kAssimp / "Collada/box_nested_animation.dae", 8, 12, {{0, -1, 0}, {2, 1, 2}}, 24, 8},
    {kAssimp / "Collada/cube_UTF8BOM.dae", 8, 12, {{-0.499999989, -0.499999989, -0.499999989}, {0.499999989, 0.499999989, 0.499999989}}, 5.99999973, 0.999999933},
    {kAssimp / "Collada/cube_emptyTags.dae", 8, 12, {{-50, -50, -50}, {50, 50, 50}}, 60000, 1000000},
    {kAssimp / "Collada/cube_triangulate.dae", 8, 12, {{-0.499999989, -0.499999989, -0.499999989}, {0.499999989, 0.499999989, 0.499999989}}, 5.99999973, 0.999999933},
    {kAssimp / "Collada/cube_tristrips.dae", 8, 12, {{-49.999997, -50.0000022, -50.0000022}, {49.999997, 50.0000022, 50.0000022}}, 59999.9976, 999999.94},
    {kAssimp / "Collada/cube_with_2UVs.DAE", 8, 12, {{-0.0253999997, 0, -0.0253999997}, {0.0253999997, 0.0507999994, 0.0253999997}}, 0.0154838396, 0.000131096507},
    {kAssimp / "Collada/cube_xmlspecialchars.dae", 8, 12, {{-0.499999989, -0.499999989, -0.499999989}, {0.499999989, 0.499999989, 0.499999989}}, 5.99999973, 0.999999933},
    {kAssimp / "Collada/duck.dae", 2108, 4212, {{-0.692984985, 0.099293697, -0.613281999}, {0.96179899, 1.63969998, 0.539252002}}, 7.02538427, 1.19552528},
    {kAssimp / "Collada/duck_triangulate.dae", 2108, 4212, {{-0.692984985, 0.099293697, -0.613281999}, {0.96179899, 1.63969998, 0.539252002}}, 7.02351713, 1.1957992},
    {kAssimp / "Collada/earthCylindrical.DAE", 964, 1920, {{-0.422754654, -0.346931755, -0.357400428}, {0.331835243, 0.346931755, 0.495713644}}, 1.65026095, 0.177554774},
    {kAssimp / "Collada/kwxport_test_vcolors.dae", 8, 12, {{-0.49999898, -0.49999898, -0.49999898}, {0.49999898, 0.5000015, 0.49999898}}, 5.99998561, 0.999996402},
    {kAssimp / "Collada/regr01.dae", 199, 172, {{-0.00510003992, -1.99999993e-08, 0}, {0.0078000297, 0.0162001704, 0.00419984004}}, 0.000499953984, 5.41833225e-07},
    {kAssimp / "Collada/sphere.dae", 382, 760, {{-0.00999999978, -0.00999999978, -0.00999999978}, {0.00999999978, 0.00999999978, 0.00999999978}}, 0.00124250059, 4.09486699e-06},
    {kAssimp / "Collada/sphere_triangulate.dae", 382, 760, {{-0.00999999978, -0.00999999978, -0.00999999978}, {0.00999999978, 0.00999999978, 0.00999999978}}, 0.00124250059, 4.09486699e-06},
    {kAssimp / "Collada/teapot_instancenodes.DAE", 1058, 2048, {{-4.82360835, 0, -1.23689819}, {1.79885789, 1.74163728, 1.04025342}}, 31.5196859, 8.69758047},
    {kAssimp / "Collada/teapots.DAE", 1587, 2976, {{-0.455226852, 0, -0.579634768}, {0.551273865, 0.493219593, 0.705666261}}, 2.15346918, 0.146781594},
    {kGlmark / "asteroid-high.3ds", 24002, 48000, {{-1.27560687, -0.884712875, -0.94646275}, {1.15175462, 0.934707046, 0.947464645}}, 12.1823132, 3.63241038},
    {kGlmark / "asteroid-low.3ds", 242, 480, {{-1.27560687, -0.884712875, -0.94646275}, {1.15175462, 0.934574783, 0.947464645}}, 11.9732564, 3.63987489},
    {kGlmark / "cat.3ds", 7340, 14348, {{-2.23316693, -1.28322458, -1.34113228}, {2.25216746, 1.24490571, 1.35303962}}, 25.6415863, 4.65073472},
    {kGlmark / "cube.3ds", 8, 12, {{-1.00000036, -1, -1.00000036}, {1.00000048, 1, 1.0000006}}, 23.9999994, 7.99999905},
    {kGlmark / "horse.3ds", 3582, 7172, {{-0.626680195, -0.382130504, -0.852197587}, {0.627070665, 0.391027898, 0.851604879}}, 2.67481695, 0.128183568},
    // clang-format on
};

TEST(RealFiles, AgreeWithAssimp) {
  for (const auto& [path, vertices, triangles, box, area, volume] : kReadByAssimp) {
    SCOPED_TRACE(path);
    const Mesh mesh = read_mesh(path).mesh;
    EXPECT_EQ(mesh.vertices.size(), vertices);
    ASSERT_EQ(mesh.triangles.size(), triangles);
    const double size = box.longest_side();
    expect_box(bounds(mesh), box, 1e-6 * size + 1e-6);
    double area_here = 0, volume_here = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 p = mesh.vertices[a], normal = cross(mesh.vertices[b] - p, mesh.vertices[c] - p);
      area_here += length(normal) / 2;
      volume_here += dot(p - box.min, normal) / 6;
    }
    EXPECT_NEAR(area_here, area, 1e-5 * area);
    EXPECT_NEAR(volume_here, volume, 1e-5 * size * area);
  }
}

// Assimp gave up on the spaces before a number.
TEST(RealFiles, ReadByUsAlone) {
  EXPECT_GT(read_mesh(kAssimp / "Collada/library_animation_clips.dae").mesh.triangles.size(), 0u);
}

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
      const Mesh mesh = read_mesh(entry.path()).mesh;
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
