// SPDX-License-Identifier: Apache-2.0
// standoff's pictures: from arrays in memory to a PNG file. With --save it hands the mesh and the field to others.
#include <filesystem>

#include "driver.h"
#include "measure.h"
#include "raw.h"
#include "signed_field.h"
#include "standoff/picture.h"
#include "workload.h"

namespace {

using namespace standoff;
using bench::Workload;

constexpr int kTurns = 8;  // pictures of a turntable

struct Settings {
  PictureOptions picture;
  bool slice = false;
  std::string save;  // a folder, or nothing
};

// Saves the input for Python, the slice's field too.
void save(const Workload& work, const DistanceField& field, const std::filesystem::path& folder) {
  bench::save_mesh(folder, work.mesh);
  if (field.grid().sample_count() == 0) return;
  const std::vector<float> values = field.to_dense();
  bench::write_raw(folder / "field.f32", values.data(), values.size());
  const Grid& grid = field.grid();
  const nlohmann::json about = {{"size", {grid.size.x, grid.size.y, grid.size.z}},
                                {"origin", {grid.origin.x, grid.origin.y, grid.origin.z}},
                                {"spacing", grid.spacing.x}};
  std::ofstream(folder / "grid.json") << about.dump();
}

nlohmann::json run(const Workload& work, Settings settings) {
  settings.picture.threads = work.threads;
  DistanceField field;
  Drawing drawing;
  drawing.meshes.push_back({.mesh = work.mesh});
  if (settings.slice) {
    field = bench::signed_field(work);
    drawing.slices.push_back({.field = &field, .axis = Axis::z});
  }
  const std::filesystem::path folder = settings.save.empty()
                                           ? std::filesystem::temp_directory_path() / "standoff_bench_render"
                                           : std::filesystem::path(settings.save);
  std::filesystem::create_directories(folder);
  if (!settings.save.empty()) save(work, field, folder);

  nlohmann::json line = work.describe();
  line["driver"] = "standoff";
  bench::measure_calls(work.repeats, "first", line,
                       [&] { write_picture(folder / "standoff.png", drawing, settings.picture); });
  bench::measure_calls(1, "turns", line,
                       [&] { write_turntable(folder / "standoff-turn.png", drawing, kTurns, settings.picture); });
  for (const char* key : {"turns_s", "turns_cpu_s"}) line[key] = line[key].get<double>() / kTurns;
  line["peak"] = bench::process_bytes("VmHWM");
  if (settings.save.empty()) std::filesystem::remove_all(folder);
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("standoff's pictures of a mesh", "bench_render");
  const bench::WorkloadOptions options(app);
  Settings settings;
  settings.picture.up = Axis::y;
  app.add_option("--width", settings.picture.width, "pixels");
  app.add_option("--height", settings.picture.height, "pixels");
  app.add_flag("--slice", settings.slice, "cut the mesh open at a slice of its signed field, in the middle of z");
  app.add_flag_callback(
      "--no-shadows", [&] { settings.picture.shadows = false; }, "no soft shadows");
  app.add_option("--save", settings.save, "write mesh, field and pictures into this folder");
  return bench::run_driver(app, options, argc, argv, [&](const Workload& work) { return run(work, settings); });
}
