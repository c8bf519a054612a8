// SPDX-License-Identifier: Apache-2.0
// Public functions when an allocation is refused, be it the first, the second or any other: Error{limit}, and nothing
// is lost.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "backends/cuda/fields.h"
#include "files/atomic_file.h"
#include "scenes/scenes.h"
#include "standoff/collision.h"
#include "standoff/compute.h"
#include "standoff/confidence.h"
#include "standoff/crossings.h"
#include "standoff/cuda.h"
#include "standoff/cuda_batch.h"
#include "standoff/cuda_compute.h"
#include "standoff/exposed.h"
#include "standoff/inspect.h"
#include "standoff/io.h"
#include "standoff/mesh_report.h"
#include "standoff/occupancy.h"
#include "standoff/page.h"
#include "standoff/picture.h"
#include "standoff/points.h"
#include "standoff/sidecars.h"
#include "standoff/slabs.h"
#include "standoff/slice.h"
#include "standoff/surface.h"
#include "standoff/testing/emulation.h"
#include "standoff/update.h"
#include "standoff/verify.h"
#include "standoff/voxels.h"
#include "tests/support/heap.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

namespace heap = testing::heap;

// Runs the call again and again, each time with another of its allocations refused, until none is. One thread, so that
// the n-th allocation is the same each time.
void expect_limit_error(const std::string& name, const std::function<void()>& call) {
  call();                              // what is made once and kept
  constexpr std::int64_t kEach = 150;  // beyond, some of them
  for (std::int64_t n = 0;; n += n < kEach ? 1 : n / 8) {
    const std::int64_t before = heap::held;
    bool happened = true;
    {
      const heap::Refusal refusal(n);
      try {
        call();
        happened = heap::Refusal::happened();
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::limit) << name << ", allocation " << n << ": " << error.what();
      } catch (const std::exception& error) {
        ADD_FAILURE() << name << ", allocation " << n << " throws what is no Error: " << error.what();
      }
    }
    EXPECT_EQ(heap::held, before) << name << ", allocation " << n << " loses memory";
    if (!happened || ::testing::Test::HasFailure()) return;
  }
}

// The same of a call that is wrong: what its error says takes memory.
void expect_error_or_limit(const std::string& name, const std::function<void()>& call) {
  expect_limit_error(name, [&] {
    try {
      call();
      ADD_FAILURE() << name << " throws nothing";
    } catch (const Error& error) {
      if (error.code() == ErrorCode::limit) throw;
    }
  });
}

const Mesh kMesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}}};
const Grid kGrid{{12, 9, 9}, {-1, -1, -1}, {0.4, 0.4, 0.4}};

ComputeOptions on_cpu() {
  return {.sign = {SignMethod::none}, .execution = {.threads = 1, .backend = Backend::cpu}, .nearest = true};
}

TEST(RefusedMemory, Computing) {
  for (const double thickness : {0.5, 100.0})
    for (const Method method : {Method::tiles, Method::thesis})
      for (const SkipRule::Kind kind : {SkipRule::Kind::automatic, SkipRule::Kind::exact}) {
        ComputeOptions options = on_cpu();
        options.method = method;
        options.skip.kind = kind;
        expect_limit_error("compute", [&] { compute(kMesh, kGrid, thickness, options); });
        const Grid tall{{9, 9, 33}, {-1, -1, -1}, {0.4, 0.4, 0.1}};
        expect_limit_error("slabs", [&] {
          SlabComputation slabs(kMesh, tall, thickness, options, 1);
          while (slabs.next()) {
          }
        });
        expect_limit_error("estimate", [&] { estimate(kMesh, tall, thickness, options, 1); });
      }
  std::vector<float> values(static_cast<std::size_t>(kGrid.sample_count()));
  std::vector<std::uint32_t> nearest(values.size());
  expect_limit_error("compute_into", [&] { compute_into(kMesh, kGrid, 1, values, nearest, on_cpu()); });
  const DistanceField field = compute(kMesh, kGrid, 0.5, on_cpu()).field;
  Mesh moved = kMesh;
  moved.vertices[moved.triangles[0][0]] = {0.01, 0.02, 0.03};
  expect_limit_error("changed", [&] { static_cast<void>(changed_triangles(kMesh, moved)); });
  expect_limit_error("update", [&] {
    DistanceField updated = field;
    update_field(kMesh, moved, changed_triangles(kMesh, moved), updated, on_cpu());
  });
  expect_limit_error("live", [&] { LiveField(kMesh, kGrid, 0.5, on_cpu()); });
  // Whatever is refused, the mesh and the field are as before, and the next move does what it should.
  const std::vector<std::uint32_t> vertex{moved.triangles[0][0]};
  const std::vector<Vec3> there{moved.vertices[vertex[0]]};
  const std::vector<float> before = field.to_dense(), after = compute(moved, kGrid, 0.5, on_cpu()).field.to_dense();
  expect_limit_error("live", [&] { LiveField(kMesh, kGrid, 0.5, on_cpu()); });
  bool happened = true;
  for (std::int64_t n = 0; happened; ++n) {
    LiveField live(kMesh, kGrid, 0.5, on_cpu());
    bool failed = false;
    {
      const heap::Refusal refusal(n);
      try {
        live.move(vertex, there);
        happened = heap::Refusal::happened();
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::limit) << "move, allocation " << n << ": " << error.what();
        failed = true;
      }
    }
    if (failed) {
      EXPECT_EQ(live.field().to_dense(), before) << "move, allocation " << n;
      live.move(vertex, there);
    }
    EXPECT_EQ(live.field().to_dense(), after) << "move, allocation " << n;
  }
  const std::vector<Vec3> points(3);
  expect_limit_error("points", [&] { closest_points(kMesh, points, {.execution = {.threads = 1}}); });
  std::vector<double> numbers(3);
  std::vector<ClosestPoint> closest(3);
  for (const SignMethod method : {SignMethod::winding, SignMethod::normal, SignMethod::shell}) {
    const MeshQueryOptions of_query{.sign = {.method = method, .shell = method == SignMethod::shell ? 0.1 : 0},
                                    .execution = {.threads = 1}};
    expect_limit_error("query", [&] { MeshQuery(kMesh, of_query); });
    const MeshQuery query(kMesh, of_query);
    expect_limit_error("distances", [&] { query.distances(points, numbers, {.execution = {.threads = 1}}); });
    expect_limit_error("closest", [&] { query.closest(points, closest, {.execution = {.threads = 1}}); });
    if (method == SignMethod::winding)
      expect_limit_error("winding_numbers",
                         [&] { query.winding_numbers(points, numbers, {.execution = {.threads = 1}}); });
    expect_error_or_limit("gradient", [&] { query.gradient({}, {}); });
    expect_error_or_limit("few", [&] { query.distances(points, {}); });
  }
  expect_limit_error("confidence", [&] {
    sign_confidence(kMesh, DistanceField(kGrid, 1), winding_margins(kMesh, kGrid, {.execution = {.threads = 1}}),
                    {.execution = {.threads = 1}});
  });
  expect_limit_error("occupancy",
                     [&] { occupancy(kMesh, kGrid, {.sign = {SignMethod::automatic}, .execution = {.threads = 1}}); });
  expect_limit_error("crossings",
                     [&] { edge_crossings(kMesh, kGrid, {.sign = {SignMethod::none}, .execution = {.threads = 1}}); });
  expect_limit_error("surface voxels", [&] { surface_voxels(kMesh, kGrid, {.execution = {.threads = 1}}); });
  const Mesh solid{kMesh.vertices, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  expect_limit_error("exposed",
                     [&] { exposed_triangles(solid, {.sign = {SignMethod::automatic}, .execution = {.threads = 1}}); });
  expect_limit_error("estimate", [&] { estimate(kMesh, kGrid, 1, on_cpu()); });
}

TEST(RefusedMemory, Fields) {
  const DistanceField field = compute(kMesh, kGrid, kFullField, on_cpu()).field;
  const std::vector<float> values = field.to_dense();
  expect_limit_error("copy", [&] { DistanceField(field).stored_tiles(); });
  expect_limit_error("assign", [&] {
    DistanceField other;
    other = field;
  });
  expect_limit_error("to_dense", [&] { field.to_dense(); });
  expect_limit_error("from_dense", [&] { DistanceField::from_dense(kGrid, 1, values); });
  expect_limit_error("store", [&] {
    DistanceField stored(kGrid, 1, true);
    stored.store_tile(0, 0, 0);
    stored.store_nearest(0, 0, 0);
  });
  VerifyOptions options{.execution = {.threads = 1}};
  std::vector<float> few(1);
  std::vector<std::uint32_t> few_nearest(1);
  expect_error_or_limit("value", [&] { field.value(-1, 0, 0); });
  expect_error_or_limit("nearest", [&] { field.nearest(12, 0, 0); });
  expect_error_or_limit("nearest", [&] { DistanceField::from_dense(kGrid, 1, values).nearest(0, 0, 0); });
  expect_error_or_limit("interpolate", [&] { field.interpolate({std::nan(""), 0, 0}); });
  expect_error_or_limit("gradient", [&] { field.gradient({std::nan(""), 0, 0}); });
  expect_error_or_limit("tile", [&] { field.tile(0, 2, 0); });
  expect_error_or_limit("tile_nearest", [&] { field.tile_nearest(0, 2, 0); });
  expect_error_or_limit("store_tile", [&] { DistanceField().store_tile(0, 0, 0); });
  expect_error_or_limit("store_nearest", [&] { DistanceField(kGrid, 1).store_nearest(0, 0, 0); });
  expect_error_or_limit("background", [&] { field.background(0, 2, 0); });
  expect_error_or_limit("mark_inside", [&] { DistanceField().mark_inside(0, 0, 0); });
  expect_error_or_limit("erase_tile", [&] { DistanceField(kGrid, 1).erase_tile(0, 0, 0); });
  const std::vector<Size3> twice(2);
  expect_error_or_limit("erase_tiles", [&] { DistanceField(kGrid, 1).erase_tiles(twice); });
  DistanceField(kGrid, 1, true).erase_nearest();
  expect_error_or_limit("tile_nearest_values", [&] { DistanceField(kGrid, 1).tile_nearest_values(); });
  expect_limit_error("tile_coordinates", [&] { field.tile_coordinates(); });
  const std::vector<Vec3> points(3);
  std::vector<Vec3> slopes(3);
  expect_limit_error("gradient", [&] { field.gradient(points, slopes, {.threads = 1}); });
  expect_error_or_limit("padding_for", [] { padding_for(-1); });
  expect_error_or_limit("padding_for_samples", [] { padding_for_samples(-1); });
  expect_error_or_limit("copy_slices", [&] { field.copy_slices(0, 1, few); });
  expect_error_or_limit("copy_nearest_slices", [&] { field.copy_nearest_slices(0, 1, few_nearest); });
  expect_limit_error("verify", [&] { verify(field, kMesh, options); });
  expect_limit_error("inspect", [&] { inspect(field); });
  const std::vector<SidecarKind> kinds{SidecarKind::gradient, SidecarKind::feature};
  expect_limit_error("sidecars", [&] { sidecars(kMesh, field, kinds, {.execution = {.threads = 1}}); });
  expect_limit_error("name_of", [] { name_of(SidecarKind::closest_point); });
}

TEST(RefusedMemory, Surfaces) {
  const DistanceField field = compute(kMesh, kGrid, kFullField, on_cpu()).field;
  for (const SurfaceMethod method : {SurfaceMethod::marching_cubes, SurfaceMethod::dual}) {
    const SurfaceOptions options{.at = 0.5, .method = method, .examine = true, .execution = {.threads = 1}};
    expect_limit_error("surface", [&] { surface(field, options); });
    expect_limit_error("surface of a mesh", [&] { surface(kMesh, kGrid, options); });
  }
}

TEST(RefusedMemory, Meshes) {
  expect_limit_error("report", [&] { report(kMesh); });
  const std::vector<Triangle> wrong{{0, 1, 9}};
  expect_error_or_limit("bounds", [&] { bounds({kMesh.vertices, wrong}); });
  expect_error_or_limit("validate", [&] { validate(MeshView{kMesh.vertices, wrong}); });
}

// As far as they go without a GPU; what they share with its kernels' emulation stands for the rest.
TEST(RefusedMemory, Devices) {
  const cuda::Task nothing;
  cuda::Outcome bad{};
  bad.stopped = 1;
  bad.bad_triangle = 7;
  expect_limit_error("devices", [] { cuda::devices(); });
  expect_limit_error("why_no_device", [] { cuda::why_no_device(); });
  expect_error_or_limit("likely_entries", [] { cuda::likely_entries(-1, kGrid, 1); });
  expect_error_or_limit("workspace_bytes", [] { cuda::workspace_bytes(-1, kGrid, 1, Method::tiles, 0); });
  expect_error_or_limit("workspace_bytes", [] { emulated::workspace_bytes(-1, kGrid, 1, Method::tiles, 0); });
  expect_error_or_limit("workspace_bytes", [&] { cuda::workspace_bytes(nothing, 0); });
  expect_error_or_limit("workspace_bytes", [&] { emulated::workspace_bytes(nothing, 0); });
  expect_error_or_limit("enqueue", [&] { cuda::enqueue(nothing, nullptr, 0, nullptr); });
  expect_error_or_limit("enqueue", [&] { cuda::enqueue({&nothing, 1}, nullptr, 0, nullptr); });
  expect_error_or_limit("enqueue", [&] { emulated::enqueue(nothing, nullptr, 0); });
  expect_error_or_limit("enqueue", [&] { emulated::enqueue({&nothing, 1}, nullptr, 0); });
  expect_error_or_limit("check", [&] { cuda::check(bad, nothing); });
  cuda::BatchTask batch;
  batch.count = -1;
  expect_error_or_limit("likely_entries", [&] { cuda::likely_entries(batch); });
  expect_error_or_limit("workspace_bytes", [&] { cuda::workspace_bytes(batch, 1); });
  expect_error_or_limit("workspace_bytes", [&] { emulated::workspace_bytes(batch, 1); });
  expect_error_or_limit("enqueue", [&] { cuda::enqueue(batch, nullptr, 0, nullptr); });
  expect_error_or_limit("enqueue", [&] { emulated::enqueue(batch, nullptr, 0); });
  expect_error_or_limit("check", [&] { cuda::check(bad, batch); });
  float values[1000];
  const cuda::OnStream on{.backend = testing::kEmulated};
  const cuda::FieldRequest requests[] = {
      {kMesh, kGrid, 1, values}, {kMesh, kGrid, -1, values}, {kMesh, kGrid, 1, values, Method::tiles, {}}};
  const MeshView meshes[] = {kMesh, {}};
  expect_limit_error("compute_each", [&] { cuda::compute_each(requests, on); });
  expect_limit_error("bounds_of_each", [&] { cuda::bounds_of_each(meshes, on); });
  expect_error_or_limit("copy_to_host", [&] { cuda::copy_to_host(nullptr, values, on); });
}

TEST(RefusedMemory, Bodies) {
  expect_limit_error("model", [&] { Body(kMesh, {.execution = {.threads = 1}}); });
  const Body body(kMesh, {.execution = {.threads = 1}});
  const Pose near = make_pose({0, 0, 1}, 0.3, {0.1, 0.2, 0.1});
  const std::vector<Pose> poses(3, near);
  const std::vector<RigidMotion> motions(3, RigidMotion{make_pose({0, 0, 1}, 0, {5, 0, 0}), near, {}});
  expect_limit_error("collide", [&] { collide(body, {}, body, near); });
  Mesh tetrahedron = kMesh;
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  expect_limit_error("closed model", [&] { Body(tetrahedron, {.execution = {.threads = 1}}); });
  const Body closed(tetrahedron, {.execution = {.threads = 1}});
  expect_limit_error("containment", [&] { collide(closed, {}, body, near, {.containment = true}); });
  expect_limit_error("containments",
                     [&] { collide_all(closed, {}, body, poses, {.containment = true}, {.threads = 1}); });
  expect_error_or_limit("no containment", [&] { collide(body, {}, body, near, {.containment = true}); });
  expect_limit_error("distance", [&] { distance(body, {}, body, near); });
  expect_limit_error("contacts", [&] { contacts(body, {}, body, near, {.margin = 0.5}); });
  expect_limit_error("sweep", [&] { sweep(body, {}, body, motions[0]); });
  expect_limit_error("collide_all", [&] { collide_all(body, {}, body, poses, {}, {.threads = 1}); });
  expect_limit_error("distance_all", [&] { distance_all(body, {}, body, poses, {}, {.threads = 1}); });
  expect_limit_error("contacts_all", [&] { contacts_all(body, {}, body, poses, {}, {.threads = 1}); });
  expect_limit_error("sweep_all", [&] { sweep_all(body, {}, body, motions, {}, {.threads = 1}); });
  expect_limit_error("batch", [&] { collide_all(body, {}, body, poses, {}, {.threads = 1, .backend = Backend::cpu}); });
}

TEST(RefusedMemory, Files) {
  const TempFolder folder;
  for (const char* name : {"a.stl", "a.ply", "a.obj"}) {
    const auto path = folder / name;
    expect_limit_error(name, [&] { write_mesh(path, kMesh); });
    expect_limit_error(name, [&] { read_mesh(path); });
  }
  expect_limit_error("notes", [&] { notes({.format = {}, .unpacked = true, .axes = {1, 3, -2}}); });
  const DistanceField field = compute(kMesh, kGrid, kFullField, on_cpu()).field;
  const std::vector<Sidecar> sidecars{
      {"feature", 1, std::vector<std::uint8_t>(static_cast<std::size_t>(512 * field.stored_tiles()))}};
  for (const char* name : {"a.vti", "a.npz"}) {
    const auto path = folder / name;
    const FieldWriteOptions one{.sidecars = sidecars, .threads = 1};
    expect_limit_error(name, [&] { write_field(path, field, one); });
    expect_limit_error(name, [&] { read_field(path); });
    expect_limit_error(name, [&] { read_field_file(path); });
  }
  DistanceField plain = field;
  plain.erase_nearest();
  for (const char* name : {"a.nrrd", "a.vdb", "a.nvdb", "a.zarr"}) {
    const auto path = folder / name;
    expect_limit_error(name, [&] { write_field(path, plain, {.threads = 1}); });
    expect_limit_error(name, [&] { read_field(path); });
  }
  const auto crossings = edge_crossings(kMesh, kGrid, {.sign = {SignMethod::none}});
  for (const char* name : {"c.npz", "c.csv"}) {
    const auto path = folder / name;
    expect_limit_error(name, [&] { write_crossings(path, crossings, kGrid); });
  }
  const Occupancy voxels = surface_voxels(kMesh, kGrid);
  for (const char* name : {"v.npz", "v.nrrd", "v.vti", "v.binvox"}) {
    const auto path = folder / name;
    expect_limit_error(name, [&] { write_voxels(path, voxels); });
  }
  const auto body_path = folder / "a.body", text = folder / "a.txt", picture = folder / "a.png";
  const Body body(kMesh, {.execution = {.threads = 1}});
  expect_limit_error("save", [&] { body.save(body_path); });
  expect_limit_error("load", [&] { Body::load(body_path); });
  const auto query_path = folder / "a.query";
  const MeshQuery query(kMesh, {.sign = {SignMethod::none}, .execution = {.threads = 1}});
  expect_limit_error("save a query", [&] { query.save(query_path); });
  expect_limit_error("load a query", [&] { MeshQuery::load(query_path); });
  expect_limit_error("write_text", [&] { write_text(text, "some"); });
  expect_limit_error("read_text", [&] { read_text(text); });
  expect_limit_error("slice", [&] { write_slice_png(picture, field); });
  expect_limit_error("slice_plane", [&] { slice_plane(field); });
  const PictureOptions small{.width = 16, .height = 16, .threads = 1};
  expect_limit_error("picture", [&] { write_mesh_png(picture, kMesh, small); });
  Drawing drawing;
  drawing.meshes.push_back({.mesh = kMesh});
  drawing.slices.push_back({.field = &field});
  expect_limit_error("drawing", [&] { write_picture(picture, drawing, small); });
  expect_limit_error("turntable", [&] { write_turntable(picture, drawing, 1, small); });
}

TEST(RefusedMemory, Pages) {
  const TempFolder folder;
  const auto path = folder / "a.html";
  const DistanceField field = compute(kMesh, kGrid, kFullField, on_cpu()).field;
  const Mesh sphere = scenes::make("sphere", 300);
  const std::vector<PageMesh> meshes{{"sphere", sphere}};
  const std::vector<PageField> fields{{"field", &field}};
  const PageOptions options{.proxy_triangles = 100};
  expect_limit_error("make_page", [&] { make_page(meshes, fields, options); });
  expect_limit_error("write_page", [&] { write_page(path, meshes, fields, options); });
  expect_limit_error("page_data of a mesh", [&] { page_data(meshes.front(), options); });
  expect_limit_error("page_data of a field", [&] { page_data(fields.front(), options); });
}

// Where nothing at all is left, the message too has to do without.
TEST(RefusedMemory, NothingLeft) {
  const heap::Limit nothing(0);
  try {
    compute(kMesh, kGrid, kFullField, on_cpu());
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::limit);
  }
}

}  // namespace
}  // namespace standoff
