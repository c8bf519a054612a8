// SPDX-License-Identifier: Apache-2.0
// Writing and reading back, scaling, and what is asked for in vain.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>
#include <thread>

#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/formats.h"
#include "tests/support/paths.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

// Rounded one by one through memory: GCC 12 drops the rounding from two neighbouring (double)(float).
double rounded(double c) {
  volatile float f = static_cast<float>(c);
  return f;
}
Vec3 rounded(Vec3 v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }

// Closed, with vertices that no float holds when `fine`.
Mesh blob(bool fine) {
  Mesh mesh;
  constexpr int rings = 20, sides = 31;
  std::mt19937 random(5);
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s < sides; ++s) {
      const double a = 0.1 + 2.9 * r / rings, b = 6.28 * s / sides,
                   size = 1 + 0.001 * static_cast<double>(random() % 1000);
      const Vec3 v{size * std::sin(a) * std::cos(b) - 0.1, size * std::sin(a) * std::sin(b), size * std::cos(a) + 1e3};
      mesh.vertices.push_back(fine ? v : rounded(v));
    }
  for (std::uint32_t r = 0; r < rings; ++r)
    for (std::uint32_t s = 0; s < sides; ++s) {
      const std::uint32_t a = r * sides + s, b = r * sides + (s + 1) % sides;
      mesh.triangles.push_back({a, b, b + sides});
      mesh.triangles.push_back({b + sides, a + sides, a});
    }
  return mesh;
}

TEST(MeshFormats, SayWhatPointsUp) {
  const TempFolder folder;
  // It stands on x.
  const Mesh mesh{{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0.3, 0.3}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}}};
  for (const auto& [name, up] : {std::pair{"m.obj", Axis::y}, {"m.stl", Axis::z}, {"m.ply", Axis::x}}) {
    write_mesh(folder / name, mesh);
    EXPECT_EQ(read_mesh(folder / name).report.up, up) << name;
  }
}

TEST(MeshFormats, PlyAndObjKeepEveryBit) {
  const TempFolder folder;
  for (const bool fine : {false, true})
    for (const char* name : {"mesh.ply", "mesh.obj", "MESH.PLY"}) {
      const Mesh mesh = blob(fine);
      write_mesh(folder / name, mesh);
      const Mesh read = read_mesh(folder / name).mesh;
      EXPECT_EQ(read.vertices, mesh.vertices) << name;
      EXPECT_EQ(read.triangles, mesh.triangles) << name;
    }
}

TEST(MeshFormats, PlyUsesFloatsWhereTheyLoseNothing) {
  const TempFolder folder;
  for (const double c : {0.1, 1e-40, 1e39, std::nextafter(0.5, 1)}) {
    const Mesh mesh{{{c, 0, 0}, {0.5, 0x1p-126, -0x1.fffffep127}, {0, 0, 1}}, {{0, 1, 2}}};
    write_mesh(folder / "one.ply", mesh);
    EXPECT_NE(read_bytes(folder / "one.ply").find("property double x"), std::string::npos) << c;
    EXPECT_EQ(read_mesh(folder / "one.ply").mesh.vertices, mesh.vertices);
  }
  write_mesh(folder / "float.ply", blob(false));
  write_mesh(folder / "double.ply", blob(true));
  EXPECT_NE(read_bytes(folder / "float.ply").find("property float x"), std::string::npos);
  EXPECT_NE(read_bytes(folder / "double.ply").find("property double x"), std::string::npos);
}

TEST(MeshFormats, StlKeepsTrianglesInOrderAndFloats) {
  const TempFolder folder;
  const Mesh mesh = blob(true);
  write_mesh(folder / "mesh.stl", mesh);
  const Mesh read = read_mesh(folder / "mesh.stl").mesh;
  ASSERT_EQ(read.triangles.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Vec3 v = MeshView(mesh).corner(t, k);
      EXPECT_EQ(MeshView(read).corner(t, k), rounded(v));
    }
  // Welded, and numbered as they come.
  EXPECT_EQ(read.vertices.size(), mesh.vertices.size());
  std::uint32_t next = 0;
  for (const Triangle& t : read.triangles)
    for (const auto v : t) {
      EXPECT_LE(v, next);
      next = std::max(next, v + 1);
    }
}

TEST(MeshFormats, GlbKeepsFloats) {
  const TempFolder folder;
  const Mesh mesh = blob(true);
  write_mesh(folder / "mesh.glb", mesh);
  const Mesh read = read_mesh(folder / "mesh.glb").mesh;
  EXPECT_EQ(read.triangles, mesh.triangles);
  ASSERT_EQ(read.vertices.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < read.vertices.size(); ++v) EXPECT_EQ(read.vertices[v], rounded(mesh.vertices[v]));
}

// y is up in glTF, whose unit is the metre.
TEST(MeshFormats, GlbStandsUp) {
  const TempFolder folder;
  const Mesh mesh = blob(true);
  for (const Axis up : {Axis::x, Axis::y, Axis::z}) {
    write_mesh(folder / "mesh.glb", mesh, {.metres_per_unit = 0.5, .up = up});
    const Mesh read = read_mesh(folder / "mesh.glb").mesh;
    ASSERT_EQ(read.vertices.size(), mesh.vertices.size());
    for (std::size_t v = 0; v < read.vertices.size(); ++v) {
      const Vec3 p = mesh.vertices[v] * 0.5;
      const Vec3 stands = up == Axis::x ? Vec3{-p.y, p.x, p.z} : up == Axis::y ? p : Vec3{p.x, p.z, -p.y};
      EXPECT_EQ(read.vertices[v], rounded(stands));
    }
  }
}

// What is known of the coordinates goes into the file, so that reading gives the same ones; else a slicer gets the
// same part as from STL: millimetres, z up.
TEST(MeshFormats, ThreemfKeepsEveryBitInMetres) {
  const TempFolder folder;
  const Mesh mesh = blob(true);
  write_mesh(folder / "mesh.3mf", mesh, {.metres_per_unit = 1, .up = Axis::y});
  EXPECT_EQ(read_mesh(folder / "mesh.3mf").mesh.vertices, mesh.vertices);
  EXPECT_EQ(read_mesh(folder / "mesh.3mf").mesh.triangles, mesh.triangles);
  write_mesh(folder / "unknown.3mf", mesh);
  const Mesh read = read_mesh(folder / "unknown.3mf").mesh;
  ASSERT_EQ(read.vertices.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < read.vertices.size(); ++v) {
    const Vec3 p = mesh.vertices[v] * 0.001;
    EXPECT_LT(length(read.vertices[v] - Vec3{p.x, p.z, -p.y}), 1e-15);
  }
  expect_error([&] { write_mesh(folder / "a.3mf", mesh, {.metres_per_unit = -1}); }, ErrorCode::usage,
               "metres per unit must be finite and not negative");
}

TEST(MeshFormats, StlNormalsAreOfUnitLengthOrZero) {
  const TempFolder folder;
  const Mesh mesh{{{0, 0, 0}, {1e-8, 0, 0}, {0, 1e-8, 0}}, {{0, 1, 2}, {2, 1, 0}, {0, 1, 1}}};
  write_mesh(folder / "mesh.stl", mesh);
  const std::string bytes = read_bytes(folder / "mesh.stl");
  ASSERT_EQ(bytes.size(), 84u + 3 * 50);
  for (const auto& [triangle, expected] : {std::pair{0, 1.f}, {1, -1.f}, {2, 0.f}}) {
    std::array<float, 3> normal;
    std::memcpy(normal.data(), bytes.data() + 84 + 50 * triangle, sizeof normal);
    EXPECT_EQ(normal, (std::array<float, 3>{0, 0, expected}));
  }
  EXPECT_FALSE(bytes.starts_with("solid"));
}

TEST(MeshFormats, ScaleMultipliesVertices) {
  const TempFolder folder;
  const Mesh mesh = blob(true);
  write_mesh(folder / "mesh.ply", mesh);
  const Mesh read = read_mesh(folder / "mesh.ply", {.scale = 0.001}).mesh;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) EXPECT_EQ(read.vertices[v], mesh.vertices[v] * 0.001);
  for (const double scale : {0.0, -1.0, double(INFINITY), double(NAN)})
    expect_error([&] { read_mesh(folder / "mesh.ply", {.scale = scale}); }, ErrorCode::usage, "scale must be positive");
  expect_error([&] { read_mesh(folder / "mesh.ply", {.scale = 1e306}); }, ErrorCode::input,
               "mesh.ply:vertex 0: infinite after scaling; ");
}

TEST(MeshFormats, UnknownAndUnwritableTargetsLeaveNothing) {
  const TempFolder folder;
  const Mesh mesh = blob(false);
  for (const char* name : {"mesh.xyz", "mesh", "mesh.3ds", "stl"})
    expect_error([&] { write_mesh(folder / name, mesh); }, ErrorCode::usage, "use one of .stl, .ply, .obj");
  expect_error([&] { write_mesh(folder / "missing/mesh.stl", mesh); }, ErrorCode::output, "missing/mesh.stl: ");
  Mesh far = mesh;
  far.vertices[3].y = 1e39;
  expect_error([&] { write_mesh(folder / "far.stl", far); }, ErrorCode::output, "far.stl: a vertex is too far");
  Mesh broken = mesh;
  broken.triangles[5][1] = 1u << 30;
  EXPECT_THROW(write_mesh(folder / "broken.ply", broken), Error);
  EXPECT_THROW(write_mesh(folder / "empty.ply", Mesh{}), Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(MeshFormats, FilesThatCannotBeReadAreNamed) {
  const TempFolder folder;
  const auto expect = [](const std::filesystem::path& path, const std::string& words) {
    expect_error([&] { read_mesh(path); }, ErrorCode::input, path.string() + ": " + words);
  };
  expect("no/such.stl", "no such file; check the name");
  expect(folder.file("a.stl", "") / "b.stl", "no such file; check the name");
  expect(folder.path(), "it is a folder; give the name of a file");
  expect("/dev/null", "it is a device; give the name of a file");
}

TEST(MeshFormats, PipesAreReadToTheirEnd) {
  const TempFolder folder;
  const Mesh mesh = blob(false);
  write_mesh(folder / "mesh.ply", mesh);
  const std::string bytes = read_bytes(folder / "mesh.ply");
  const auto pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << bytes; });
  const Mesh read = read_mesh(pipe).mesh;
  writer.join();
  EXPECT_EQ(read.vertices, mesh.vertices);
  EXPECT_EQ(read.triangles, mesh.triangles);
}

bool readable(const std::string& extension) {
  return std::ranges::any_of(mesh_formats(),
                             [&](const FileFormat& f) { return f.extension == extension && f.readable; });
}

void write_packed(const std::filesystem::path& path, const std::string& bytes, int times = 1) {
  const gzFile file = ::gzopen(path.c_str(), "wb1");
  for (; times > 0; --times)
    ASSERT_EQ(::gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size())), static_cast<int>(bytes.size()));
  ASSERT_EQ(::gzclose(file), Z_OK);
}

TEST(MeshFormats, PackedMeshesOfEveryWrittenFormatAreRead) {
  const TempFolder folder;
  const Mesh mesh = blob(false);
  for (const std::string name : {"mesh.stl", "mesh.ply", "mesh.obj"}) {
    write_mesh(folder / name, mesh);
    write_packed(folder / (name + ".gz"), read_bytes(folder / name));
    const Mesh plain = read_mesh(folder / name).mesh, packed = read_mesh(folder / (name + ".gz")).mesh;
    EXPECT_EQ(packed.vertices, plain.vertices) << name;
    EXPECT_EQ(packed.triangles, plain.triangles) << name;
    expect_error([&] { write_mesh(folder / (name + ".gz"), mesh); }, ErrorCode::usage, "use one of .stl, .ply, .obj");
  }
}

// A hundred kilobytes that would become a hundred megabytes.
TEST(MeshFormats, PackedFilesThatBecomeFarTooLargeAreRefused) {
  const TempFolder folder;
  write_packed(folder / "mesh.obj.gz", std::string(1 << 20, '\n'), 100);
  ASSERT_LT(std::filesystem::file_size(folder / "mesh.obj.gz"), 1u << 19);
  expect_error([&] { read_mesh(folder / "mesh.obj.gz"); }, ErrorCode::limit, "mesh.obj.gz: it unpacks to more than ");
}

TEST(MeshFormats, ReportsWhatWasDoneToCoordinates) {
  const std::filesystem::path corpus = std::filesystem::path(kSourceFolder) / "tests/corpus";
  MeshReadReport report = read_mesh(corpus / "mesh/gz_gltf.gltf.gz").report;
  EXPECT_EQ(report.format, "gltf");
  EXPECT_TRUE(report.unpacked);
  EXPECT_EQ(report.metres_per_unit, 1);
  EXPECT_FALSE(report.turned());
  EXPECT_EQ(notes(report), (std::vector<std::string>{"unpacked by gzip", "in metres, as the format says"}));
  report = read_mesh(corpus / "mesh/obj_plain.obj", {.scale = 2}).report;
  EXPECT_EQ(report.format, "obj");
  EXPECT_TRUE(notes(report).empty());
  if (!readable("dae")) return;
  const MeshReadResult tetrahedron = read_mesh(corpus / "scene/tetrahedron.dae");
  report = tetrahedron.report;
  EXPECT_EQ(report.axes, (std::array<int, 3>{1, 3, -2}));
  EXPECT_EQ(report.unit_scale, 0.01);
  EXPECT_EQ(notes(report).at(0), "axes turned so that y is up: x, y, z are x, z, -y of the file");
  EXPECT_EQ(notes(report).at(1), "coordinates multiplied by 0.01, as the file's unit asks for");
  // As the file has it: turned by 90 degrees about z, and moved by (1, 2, 3) after.
  EXPECT_NEAR(tetrahedron.mesh.vertices[0].y, 0.03, 1e-8);
  report = read_mesh(corpus / "scene/tetrahedron.3ds").report;
  EXPECT_EQ(report.axes, (std::array<int, 3>{1, 3, -2}));
  EXPECT_EQ(report.unit_scale, 1);
  EXPECT_EQ(report.metres_per_unit, 0);
}

TEST(MeshFormats, AreThoseThatTheDocumentationNames) {
  const std::string names = documented("## Meshes");
  for (const FileFormat& format : mesh_formats()) {
    const std::string name = find_mesh_format(format.extension)->name;
    EXPECT_TRUE(names.find(name) != names.npos) << "docs/formats.md: no row of " << name;
  }
}

TEST(MeshFormats, TableTellsWhatThisBuildCan) {
  std::string written, read;
  for (const FileFormat& format : mesh_formats()) {
    if (format.writable) written += format.extension + " ";
    if (format.readable) read += format.extension + " ";
    EXPECT_FALSE(format.description.empty());
  }
  EXPECT_EQ(written, "stl ply obj glb 3mf ");
  EXPECT_TRUE(read.starts_with("stl ply obj off ")) << read;
}

}  // namespace
}  // namespace standoff
