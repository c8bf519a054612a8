// SPDX-License-Identifier: Apache-2.0
// crossings.h, voxels.h and sidecars.h with arguments that make no sense.
#include "standoff/compute.h"
#include "standoff/crossings.h"
#include "standoff/sidecars.h"
#include "standoff/voxels.h"
#include "tests/api/misuse.h"

namespace standoff {
namespace {

using namespace testing;

const Grid kSampleGrid{{9, 9, 9}, {-1, -1, -1}, {0.4, 0.4, 0.4}};
const std::vector<SidecarKind> kKinds{SidecarKind::closest_point, SidecarKind::barycentric, SidecarKind::feature,
                                      SidecarKind::gradient};

DistanceField field_of(const Mesh& mesh, const Grid& grid) {
  ComputeOptions options{
      .sign = {SignMethod::none}, .execution = {.threads = 1, .backend = Backend::cpu}, .nearest = true};
  return compute(mesh, grid, kFullField, options).field;
}

TEST(MisuseOfSamples, GridsAndMeshes) {
  const Mesh mesh = one_triangle();
  for (const Grid& grid : odd_grids()) {
    const std::string name = "grid " + std::to_string(grid.size.x) + "x" + std::to_string(grid.size.y) + "x" +
                             std::to_string(grid.size.z) + ", spacing " + std::to_string(grid.spacing.y);
    expect_answer_or_error(name, [&] { edge_crossings(mesh, grid, {.sign = {SignMethod::none}}); });
    expect_answer_or_error(name, [&] { surface_voxels(mesh, grid); });
    expect_answer_or_error(name, [&] { sidecars(mesh, field_of(mesh, grid), kKinds); });
  }
  const DistanceField field = field_of(mesh, kSampleGrid);
  for (const Mesh& odd : odd_meshes()) {
    expect_answer_or_error("crossings", [&] { edge_crossings(odd, kSampleGrid, {.sign = {SignMethod::none}}); });
    expect_answer_or_error("voxels", [&] { surface_voxels(odd, kSampleGrid); });
    expect_answer_or_error("sidecars", [&] { sidecars(odd, field, kKinds); });
  }
}

TEST(MisuseOfSamples, Options) {
  const Mesh mesh = one_triangle();
  const DistanceField field = field_of(mesh, kSampleGrid);
  for (const int threads : kThreads) {
    const Execution execution{.threads = threads};
    expect_usage("crossings",
                 [&] { edge_crossings(mesh, kSampleGrid, {.sign = {SignMethod::none}, .execution = execution}); });
    expect_usage("voxels", [&] { surface_voxels(mesh, kSampleGrid, {.execution = execution}); });
    expect_usage("sidecars", [&] { sidecars(mesh, field, kKinds, {.execution = execution}); });
  }
  expect_usage("method", [&] { edge_crossings(mesh, kSampleGrid, {.sign = {none_of<SignMethod>()}}); });
  expect_usage("kind", [&] { sidecars(mesh, field, std::vector{none_of<SidecarKind>()}); });
  expect_usage("kind", [] { bytes_per_sample(none_of<SidecarKind>()); });
  EXPECT_EQ(name_of(none_of<SidecarKind>()), "");
  expect_usage("no nearest", [&] { sidecars(mesh, DistanceField(kSampleGrid, 1), kKinds); });
  EXPECT_TRUE(sidecars(mesh, field, {}).empty());
  std::vector<Sidecar> into{{"other", 2, std::vector<std::uint8_t>(7)}, {}, {}};
  sidecars_into(mesh, field, kKinds, into);
  EXPECT_EQ(into.size(), kKinds.size());
}

TEST(MisuseOfSamples, Files) {
  Occupancy voxels = surface_voxels(one_triangle(), kSampleGrid);
  const std::vector<EdgeCrossing> odd(3);
  for (const char* name : {"", "a", "a.stl", "/no/such/folder/a.npz", "/no/such/folder/a.binvox"}) {
    expect_answer_or_error(name, [&] { write_voxels(name, voxels); });
    expect_answer_or_error(name, [&] { write_crossings(name, odd, kSampleGrid); });
  }
  for (const Grid& grid : odd_grids())
    expect_answer_or_error("bits of another grid", [&] { write_voxels("a.npz", Occupancy{grid, voxels.bits, {}}); });
  expect_usage("add", [&] { add_voxels(voxels, Occupancy{}); });
}

}  // namespace
}  // namespace standoff
