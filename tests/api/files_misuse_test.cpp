// SPDX-License-Identifier: Apache-2.0
// io.h, picture.h, slice.h and cuda.h with arguments that make no sense.
#include "files/atomic_file.h"
#include "standoff/cuda.h"
#include "standoff/cuda_batch.h"
#include "standoff/cuda_compute.h"
#include "standoff/io.h"
#include "standoff/picture.h"
#include "standoff/points.h"
#include "standoff/slabs.h"
#include "standoff/slice.h"
#include "standoff/testing/emulation.h"
#include "standoff/version.h"
#include "tests/api/misuse.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

using namespace testing;

std::vector<std::filesystem::path> odd_paths(const TempFolder& folder) {
  std::vector<std::filesystem::path> paths{"", "/", ".", "..", folder / "none", std::string(5000, 'a')};
  std::vector<std::string> extensions{"png"};
  for (const auto& formats : {mesh_formats(), field_formats()})
    for (const FileFormat& format : formats) extensions.push_back(format.extension);
  for (const std::string& extension : extensions) {
    paths.push_back(folder / "no such folder" / ("a." + extension));
    paths.push_back(folder / ("a." + extension));
    paths.push_back("." + extension);
  }
  return paths;
}

// An empty field in slabs of another one, forever.
class OddSlabs final : public FieldSlabs {
 public:
  const Grid& grid() const override { return none_.grid(); }
  double thickness() const override { return kNaN; }
  bool has_nearest() const override { return false; }
  const Provenance& provenance() const override { return none_.provenance(); }
  const DistanceField* next() override { return &some_; }

 private:
  DistanceField none_, some_{{{3, 3, 3}, {}}, 1};
};

TEST(Misuse, Reading) {
  const TempFolder folder;
  for (const auto& path : odd_paths(folder)) {
    expect_answer_or_error(path.string(), [&] { read_mesh(path); });
    expect_answer_or_error(path.string(), [&] { read_field(path); });
    expect_answer_or_error(path.string(), [&] { read_field_file(path); });
    expect_answer_or_error(path.string(), [&] { read_text(path); });
    expect_answer_or_error(path.string(), [&] { MeshQuery::load(path); });
  }
  const auto mesh = folder / "mesh.obj", field = folder / "field.vti";
  write_mesh(mesh, one_triangle());
  write_field(field, DistanceField({{3, 3, 3}, {}}, 1));
  for (const double x : kNumbers) expect_answer_or_error(named("scale", x), [&] { read_mesh(mesh, {x}); });
  // The letter of an axis was read from outside of "xyz".
  for (const int axis : {0, 4, -4, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()})
    expect_usage(named("axis", axis), [&] { notes({.format = {}, .axes = {1, 2, axis}}); });
  for (const double x : kNumbers)
    expect_answer_or_error(named("unit", x), [&] { notes({.format = {}, .unit_scale = x, .metres_per_unit = x}); });
  for (const std::int64_t n : kCounts) {
    expect_answer_or_error(named("limit", n), [&] { read_field(field, {n}); });
    expect_answer_or_error(named("limit", n), [&] { read_field_file(field, {n}); });
  }
}

TEST(Misuse, Writing) {
  const TempFolder folder;
  const DistanceField field({{3, 3, 3}, {}}, 1, true);
  for (auto path : odd_paths(folder)) {
    if (path.is_relative()) path = folder / "none" / path;  // nothing is left where the test runs
    const std::string name = path.string();
    expect_answer_or_error(name, [&] { write_mesh(path, one_triangle()); });
    expect_answer_or_error(name, [&] { write_mesh(path, Mesh{}, none_of<Existing>()); });
    expect_answer_or_error(name, [&] { write_field(path, field); });
    expect_answer_or_error(name, [&] { write_field(path, {}); });
    expect_answer_or_error(name, [&] { write_field(path, {}, none_of<Existing>()); });
    expect_answer_or_error(name, [&] { write_field(path, field, {.compress = false, .threads = -1}); });
    const Mesh triangle = one_triangle();
    const std::vector<Sidecar> odd{{"", -1, {}}, {std::string(1000, 'n'), 1 << 30, std::vector<std::uint8_t>(7)}};
    expect_answer_or_error(name, [&] { write_field(path, field, {.sidecars = odd}); });
    SlabComputation slabs(triangle, {{3, 3, 33}, {}}, 1, {.sign = {SignMethod::none}}, 1);
    expect_answer_or_error(name, [&] { write_field(path, slabs, {.sidecars = odd}); });
    expect_answer_or_error(name, [&] { write_field(path, slabs, {.threads = -1}); });
    expect_answer_or_error(name, [&] { write_field(path, slabs); });
    expect_answer_or_error(name, [&] { write_field(path, slabs); });  // used up
    OddSlabs odd_slabs;
    expect_answer_or_error(name, [&] { write_field(path, odd_slabs); });
    expect_answer_or_error(name, [&] { write_text(path, {}); });
    expect_answer_or_error(name, [&] { MeshQuery(one_triangle()).save(path, none_of<Existing>()); });
    expect_answer_or_error(name, [&] { write_slice_png(path, field); });
    expect_answer_or_error(name, [&] { write_mesh_png(path, one_triangle(), {.width = 16, .height = 16}); });
    expect_answer_or_error(name, [&] { write_picture(path, {}, {}, none_of<Existing>()); });
    Drawing drawing;
    drawing.meshes.push_back({.mesh = triangle});
    expect_answer_or_error(name, [&] { write_turntable(path, drawing, 2, {.width = 16, .height = 16}); });
  }
  for (const Mesh& mesh : odd_meshes())
    for (const char* file : {"a.stl", "a.ply", "a.obj"})
      expect_answer_or_error(file, [&] { write_mesh(folder / file, mesh); });
  EXPECT_FALSE(mesh_formats().empty() || field_formats().empty());
  EXPECT_STRNE(version(), "");
  remove_unfinished_files();
}

TEST(Misuse, Pictures) {
  const TempFolder folder;
  const auto path = folder / "a.png";
  const auto expect = [&](const std::string& name, const PictureOptions& options) {
    for (const Mesh& mesh : odd_meshes()) expect_answer_or_error(name, [&] { write_mesh_png(path, mesh, options); });
  };
  const PictureOptions small{.width = 16, .height = 16};
  for (const int n : {std::numeric_limits<int>::min(), -1, 0, 15, 8193, std::numeric_limits<int>::max()}) {
    expect(named("width", n), {.width = n, .height = 16});
    expect(named("height", n), {.width = 16, .height = n});
  }
  for (const double x : kNumbers) {
    PictureOptions azimuth = small, elevation = small;
    azimuth.azimuth_deg = elevation.elevation_deg = x;
    expect(named("azimuth", x), azimuth);
    expect(named("elevation", x), elevation);
  }
  PictureOptions no_axis = small, no_background = small;
  no_axis.up = none_of<Axis>();
  no_background.background = none_of<Background>();
  expect("axis", no_axis);
  expect("background", no_background);
  const Mesh triangle = one_triangle();
  const DistanceField field({{3, 3, 3}, {}}, 1), empty;
  for (const double x : kNumbers) {
    const std::vector<Vec3> points{{0, 0, 0}, {x, 1, -x}};
    const std::vector<double> values{x, -x};
    Drawing drawing{.meshes = {{.mesh = triangle, .opacity = x, .shading = none_of<Shading>()}},
                    .slices = {{.field = &field, .axis = none_of<Axis>(), .at = x}, {.field = &empty}},
                    .bands = {{.field = &field, .within = x}, {.field = &empty}},
                    .points = {{.points = points, .radius = x, .values = values}},
                    .paths = {{.points = points, .radius = x, .values = values}},
                    .boxes = {{.box = {{0, 0, 0}, {x, x, x}}}},
                    .colormap = none_of<Colormap>()};
    const auto draw = [&](const char* layer, const Drawing& part) {
      expect_answer_or_error(named(layer, x), [&] { write_picture(path, part, small); });
    };
    draw("all", drawing);
    draw("meshes", {.meshes = drawing.meshes});
    draw("slices", {.slices = {{.field = &field, .at = x}, {.field = &empty}}});
    draw("bands", {.bands = drawing.bands});
    draw("points", {.points = drawing.points});
    draw("values", {.points = {{.points = points, .values = values}}});
    draw("paths", {.paths = {{.points = points, .values = values}}});
    draw("boxes", {.boxes = drawing.boxes});
  }
  for (const int n : {std::numeric_limits<int>::min(), 0, 721}) {
    expect_answer_or_error(named("turntable file", n), [&] { turntable_file(path, n); });
    expect_answer_or_error(named("turntable", n), [&] { write_turntable(path, {}, n, small); });
  }
}

TEST(Misuse, Slices) {
  const TempFolder folder;
  const auto path = folder / "a.png";
  for (const DistanceField& field : {DistanceField(), DistanceField({{3, 4, 5}, {}}, 1)}) {
    const auto expect = [&](const std::string& name, const SliceOptions& options) {
      expect_answer_or_error(name, [&] { write_slice_png(path, field, options); });
      expect_answer_or_error(name, [&] { slice_plane(field, options); });
    };
    const auto with = [](auto SliceOptions::*member, auto value) {
      SliceOptions options;
      options.*member = value;
      return options;
    };
    for (const double x : kNumbers) expect(named("at", x), with(&SliceOptions::at, x));
    for (const std::int64_t n : kCounts) expect(named("index", n), with(&SliceOptions::index, n));
    for (const int n : {std::numeric_limits<int>::min(), -1, 0, 1, 8193, std::numeric_limits<int>::max()})
      expect(named("pixels", n), with(&SliceOptions::pixels, n));
    expect("axis", with(&SliceOptions::axis, none_of<Axis>()));
    expect("colormap", with(&SliceOptions::colormap, none_of<Colormap>()));
    expect("interpolation", with(&SliceOptions::interpolation, none_of<Interpolation>()));
    expect("background", with(&SliceOptions::background, none_of<Background>()));
    for (const std::string& words : {std::string("\xff\xc3"), std::string(3, '\0'), std::string(1000, 'm')}) {
      expect("title", with(&SliceOptions::title, words));
      expect("unit", with(&SliceOptions::unit, words));
      expect("legend", with(&SliceOptions::legend, words));
    }
  }
}

TEST(Misuse, DeviceMemory) {
  const Grid grid{{9, 9, 9}, {}};
  for (const std::int64_t n : kCounts)
    for (const double x : kNumbers)
      for (const Method method : {Method::tiles, Method::thesis, none_of<Method>()}) {
        const std::string name = named("count", n) + named(", thickness", x);
        expect_answer_or_error(name, [&] { EXPECT_GE(cuda::likely_entries(n, grid, x, method), 0); });
        expect_answer_or_error(name, [&] { EXPECT_GT(cuda::workspace_bytes(n, grid, x, method, 1), 0); });
        expect_answer_or_error(name, [&] { EXPECT_GT(cuda::workspace_bytes(1, grid, x, method, n), 0); });
      }
  for (const Grid& odd : odd_grids())
    expect_answer_or_error("grid", [&] { EXPECT_GE(cuda::likely_entries(1, odd, 1), 0); });
  for (const std::int64_t n : kCounts)
    for (const SignMethod sign : {SignMethod::none, SignMethod::winding, none_of<SignMethod>()}) {
      cuda::Task sized;
      sized.grid = grid;
      sized.thickness = 1;
      sized.sign.method = sign;
      sized.mesh.vertex_count = n;
      sized.mesh.triangle_count = n;
      expect_answer_or_error(named("count", n), [&] { EXPECT_GT(cuda::workspace_bytes(sized, n), 0); });
      expect_answer_or_error(named("count", n), [&] { cuda::enqueue(sized, nullptr, n, nullptr); });
    }
  const cuda::Task task;
  for (const std::int64_t bytes : kCounts)
    expect_answer_or_error("enqueue", [&] { cuda::enqueue(task, nullptr, bytes, nullptr); });
  expect_answer_or_error("enqueue", [&] { cuda::enqueue(std::span<const cuda::Task>(&task, 1), nullptr, 0, nullptr); });
  expect_answer_or_error("check", [&] { cuda::check({1, cuda::Outcome::kNone, ~0ull, ~0ull, 0, 0, 0}, task); });
  expect_answer_or_error("check", [&] { cuda::check({1, 0, 0, 0, 0, 0, ~0ull}, task); });
  for (const std::int64_t n : kCounts) {
    cuda::BatchTask batch;
    batch.size = grid.size;
    batch.count = batch.vertex_count = batch.triangle_count = n;
    const std::string name = named("count", n);
    expect_answer_or_error(name, [&] { EXPECT_GE(cuda::likely_entries(batch), 0); });
    expect_answer_or_error(name, [&] { EXPECT_GT(cuda::workspace_bytes(batch, n), 0); });
    expect_answer_or_error(name, [&] { cuda::enqueue(batch, nullptr, n, nullptr); });
    batch.size = {n, n, n};
    expect_answer_or_error(name, [&] { EXPECT_GE(cuda::likely_entries(batch), 0); });
    expect_answer_or_error(name, [&] { EXPECT_GT(cuda::workspace_bytes(batch, n), 0); });
    expect_answer_or_error(name, [&] { cuda::check({1, cuda::Outcome::kNone, ~2ull, 0, 0, 0, 0}, batch); });
  }
  float values[8];
  for (const Backend backend : {Backend::automatic, Backend::cpu, Backend::cuda, testing::kEmulated}) {
    const cuda::OnStream on{.backend = backend, .device = backend == testing::kEmulated ? -1 : 4711};
    const Mesh nothing;
    const cuda::FieldRequest requests[] = {{}, {nothing, {{2, 2, 2}, {}}, 1, values, none_of<Method>()}};
    expect_answer_or_error("compute_each", [&] { EXPECT_EQ(cuda::compute_each(requests, on).size(), 2u); });
    expect_answer_or_error("bounds_of_each", [&] { cuda::bounds_of_each(std::vector<MeshView>(2), on); });
    expect_answer_or_error("copy_to_host", [&] { cuda::copy_to_host(nullptr, values, on); });
  }
  cuda::devices();
  cuda::why_no_device();
}

}  // namespace
}  // namespace standoff
