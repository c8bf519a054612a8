// SPDX-License-Identifier: Apache-2.0
// Files: reading and writing can be stopped on the way, and what was there before a write that is stopped is still
// there.
#include <gtest/gtest.h>

#include <fstream>

#include "standoff/compute.h"
#include "standoff/io.h"
#include "standoff/slabs.h"
#include "tests/api/stop_everywhere.h"
#include "tests/collision/bodies.h"
#include "tests/support/temp_folder.h"

namespace standoff::testing {
namespace {

// Files of it are several times as large as what is read or written between two looks at the callback.
const Mesh kBall = ball_mesh(1, 60);

const DistanceField& field() {
  static const DistanceField full =
      compute(kBall, fit_resolution(bounds(kBall), 72), kFullField, {.sign = {SignMethod::none}}).field;
  return full;
}

// As stop_everywhere, and while the write is stopped, the file is what it was.
int stop_writing(const std::filesystem::path& path, const std::function<void(const ProgressCallback&)>& write) {
  if (path.extension() == ".zarr")  // a folder, which takes the place of another one alone
    write_field(path, DistanceField({{3, 3, 3}, {}}, 1));
  else
    write_bytes(path, "precious");
  const std::string before = read_bytes(path);
  const int stops = stop_everywhere([&](const ProgressCallback& progress) {
    EXPECT_TRUE(read_bytes(path) == before);
    write(progress);
  });
  EXPECT_FALSE(read_bytes(path) == before);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& file : std::filesystem::directory_iterator(path.parent_path())) ++files;
  EXPECT_EQ(files, 1u);
  return stops;
}

TEST(Interrupted, Meshes) {
  for (const FileFormat& format : mesh_formats()) {
    if (!format.writable || !format.readable) continue;
    SCOPED_TRACE(format.extension);
    const TempFolder folder;
    const auto path = folder / ("ball." + format.extension);
    EXPECT_GE(stop_writing(path, [&](const auto& progress) { write_mesh(path, kBall, {.progress = progress}); }), 4);
    EXPECT_GE(stop_everywhere([&](const auto& progress) {
                EXPECT_EQ(read_mesh(path, {.progress = progress}).mesh.triangles.size(), kBall.triangles.size());
              }),
              5);
  }
}

// By the callback of the computation, and by that of the writing.
TEST(Interrupted, FieldsInSlabs) {
  for (const FileFormat& format : field_formats()) {
    if (!format.slabs) continue;
    SCOPED_TRACE(format.extension);
    const TempFolder folder;
    const auto path = folder / ("ball." + format.extension);
    const auto write = [&](const ProgressCallback& computing, const ProgressCallback& writing) {
      const Grid grid = fit_resolution(bounds(kBall), 72);
      ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = 1}, .progress = computing};
      SlabComputation slabs(kBall, grid, 0.1, options, 1);
      write_field(path, slabs, {.threads = 1, .progress = writing});
    };
    EXPECT_GE(stop_writing(path, [&](const auto& progress) { write(progress, {}); }), 20);
    EXPECT_GE(stop_writing(path, [&](const auto& progress) { write({}, progress); }), 4);
  }
}

TEST(Interrupted, MeshesOfText) {
  const TempFolder folder;
  std::ofstream off(folder / "ball.off"), stl(folder / "ball.stl"), medit(folder / "ball.mesh");
  off << "OFF\n" << kBall.vertices.size() << ' ' << kBall.triangles.size() << " 0\n";
  medit << "MeshVersionFormatted 2\nDimension 3\nVertices " << kBall.vertices.size() << '\n';
  for (const Vec3& v : kBall.vertices) {
    off << v.x << ' ' << v.y << ' ' << v.z << '\n';
    medit << v.x << ' ' << v.y << ' ' << v.z << " 0\n";
  }
  medit << "Triangles " << kBall.triangles.size() << '\n';
  stl << "solid ball\n";
  for (const Triangle& t : kBall.triangles) {
    off << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
    medit << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << " 0\n";
    stl << "facet normal 0 0 0\nouter loop\n";
    for (const auto v : t)
      stl << "vertex " << kBall.vertices[v].x << ' ' << kBall.vertices[v].y << ' ' << kBall.vertices[v].z << '\n';
    stl << "endloop\nendfacet\n";
  }
  medit << "End\n";
  stl << "endsolid\n";
  off.close(), stl.close(), medit.close();
  for (const char* name : {"ball.off", "ball.stl", "ball.mesh"}) {
    SCOPED_TRACE(name);
    EXPECT_GE(stop_everywhere([&](const auto& progress) {
                EXPECT_EQ(read_mesh(folder / name, {.progress = progress}).mesh.triangles.size(),
                          kBall.triangles.size());
              }),
              10);
  }
}

TEST(Interrupted, Fields) {
  for (const FileFormat& format : field_formats())
    for (const bool compress : {false, true}) {
      SCOPED_TRACE(format.extension + (compress ? ", compressed" : ""));
      const TempFolder folder;
      const auto path = folder / ("ball." + format.extension);
      EXPECT_GE(stop_writing(path,
                             [&](const auto& progress) {
                               write_field(path, field(), {.compress = compress, .threads = 1, .progress = progress});
                             }),
                4);
      EXPECT_GE(stop_everywhere([&](const auto& progress) {
                  EXPECT_EQ(read_field(path, {.progress = progress}).grid().size, field().grid().size);
                }),
                4);
    }
}

// What a callback throws comes out as it is, and nothing is written.
TEST(Interrupted, FilesByAnExceptionOfTheCallback) {
  struct Stop {};
  const auto throws = [](const Progress&) -> bool { throw Stop{}; };
  const TempFolder folder;
  EXPECT_THROW(write_mesh(folder / "a.ply", kBall, {.progress = throws}), Stop);
  EXPECT_THROW(write_field(folder / "a.vdb", field(), {.progress = throws}), Stop);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.ply") || std::filesystem::exists(folder / "a.vdb"));
  write_mesh(folder / "a.ply", kBall);
  write_field(folder / "a.vdb", field());
  EXPECT_THROW(read_mesh(folder / "a.ply", {.progress = throws}).mesh, Stop);
  EXPECT_THROW(read_field(folder / "a.vdb", {.progress = throws}), Stop);
}

}  // namespace
}  // namespace standoff::testing
