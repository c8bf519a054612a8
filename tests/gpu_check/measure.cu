// SPDX-License-Identifier: Apache-2.0
// gpu-check, second part: how long fields take, device memory to device memory, by CUDA events. Reads jobs from stdin,
// a line each:
//   TABLE SCENE TRIANGLES METHOD OUTPUT NX NY NZ EX EY EZ SCALE MARGIN THICKNESS SECONDS_2008 AT_MOST_MS
// TRIANGLES 0: the scene's own. OUTPUT: dense, sparse, graph (dense, replayed as a CUDA graph), host (from host memory
// to host memory, dense), upload and download (its copies alone), compute (what compute() does of it: from host memory
// to a new sparse field there), nearest (dense, with nearest triangles), beside (the same with closest points and
// gradients), signed and signed_sparse (with the device's sign), counting (the part of dense before
// triangles are listed), batch_N (N meshes in one sequence of launches; SCENE is then many: copies of eight scenes, of
// about TRIANGLES triangles each), singles_N (the same one after the other), or dense with parts left out (parts.cuh).
// The grid has NX NY NZ cells in a box of EX EY EZ units, a sample in the middle of each. SCALE is the mesh's, or 0 to
// stretch it until MARGIN units are left on each side. THICKNESS in units, or inf. SECONDS_2008: the thesis's time;
// AT_MOST_MS: what we want; either may be -, and both are only written beside what is measured. Writes a CSV line each.
// measure --once: each is run once, to try it.
// measure --continue: without the line of names on top, to add to a file.
// measure --profile: measures nothing; each is run as often as its room takes, and once more while a profiler that was
// told to wait (ncu --profile-from-start off) may look.
// measure --export FOLDER: measures nothing, but writes SCENE-THICKNESS-NX.bin for peers (peer_file.h).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>

#include "scenes/scenes.h"
#include "standoff/error.h"
#include "tests/gpu_check/batch_on_device.cuh"
#include "tests/gpu_check/field_on_device.cuh"
#include "tests/gpu_check/parts.cuh"
#include "tests/gpu_check/peer_file.h"
#include "tests/gpu_check/timing.cuh"

namespace standoff::STANDOFF_PLATFORM {
namespace {

struct Line {
  std::string table, scene, method, output, thickness, seconds_2008, at_most_ms;
  std::int64_t triangles;
  Size3 size;
  Vec3 extent;
  double scale, margin;
};

bool read(Line& l) {
  return static_cast<bool>(std::cin >> l.table >> l.scene >> l.triangles >> l.method >> l.output >> l.size.x >>
                           l.size.y >> l.size.z >> l.extent.x >> l.extent.y >> l.extent.z >> l.scale >> l.margin >>
                           l.thickness >> l.seconds_2008 >> l.at_most_ms);
}

/// The mesh, scaled or stretched, in the middle of the box from the origin to `extent`.
Mesh placed(const Line& l, const std::string& scene, std::int64_t triangles) {
  Mesh mesh = scenes::make(scene, triangles);
  const Box box = bounds(mesh);
  const Vec3 old = box.extent(), target = l.extent - Vec3{2, 2, 2} * l.margin;
  const auto factor = [&](double to, double from) { return l.scale > 0 ? l.scale : from > 0 ? to / from : 1; };
  const Vec3 scale{factor(target.x, old.x), factor(target.y, old.y), factor(target.z, old.z)};
  for (Vec3& v : mesh.vertices) v = (v - box.center()) * scale + 0.5 * l.extent;
  return mesh;
}

/// Meshes of eight scenes and sizes, each copy at its own place and of its own scale.
testing::MeshBatch many(const Line& l, std::int64_t count, double thickness) {
  constexpr std::pair<const char*, double> kKinds[] = {{"sphere", 0.2}, {"fly", 0.3},     {"catapult", 0.5},
                                                       {"bender", 0.6}, {"terrain", 0.8}, {"machine_2", 0.9},
                                                       {"plane", 1},    {"nested", 4}};
  std::vector<Mesh> kinds;
  for (const auto& [scene, share] : kKinds)
    kinds.push_back(placed(l, scene, std::llround(share * static_cast<double>(l.triangles))));
  const Vec3 spacing = l.extent / Vec3{double(l.size.x), double(l.size.y), double(l.size.z)};
  testing::MeshBatch all;
  for (std::int64_t n = 0; n < count; ++n) {
    const double scale = 1 + static_cast<double>(n % 97) / 97;
    const Vec3 at{7.0 * static_cast<double>(n), -3.0 * static_cast<double>(n % 1000), 0.25};
    Mesh mesh = kinds[static_cast<std::size_t>(n) % std::size(kKinds)];
    for (Vec3& v : mesh.vertices) v = scale * v + at;
    all.add(mesh, {at + 0.5 * scale * spacing, scale * spacing, scale * thickness});
  }
  return all;
}

/// The number behind a prefix of an output's name, or 0.
std::int64_t number_behind(const std::string& prefix, const std::string& output) {
  return output.starts_with(prefix) ? std::stoll(output.substr(prefix.size())) : 0;
}

struct Times {
  double median, least;
  int runs;
};

std::string export_folder;
bool profiles = false;
std::size_t least_runs = 5, most_runs = 50;

/// Once to warm up, then as often as fits into a second, within bounds.
template <class Once>
Times repeated(Once once) {
  std::vector<double> all;
  double total = 0;
  once();
  while (all.size() < least_runs || (all.size() < most_runs && total < 1000)) {
    all.push_back(once());
    total += all.back();
  }
  std::sort(all.begin(), all.end());
  return {all[all.size() / 2], all.front(), static_cast<int>(all.size())};
}

/// Milliseconds on the host's clock: for work that ends with its call.
template <class Work>
double on_host(Work work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
}

bool is_signed(const Line& l) { return l.output.starts_with("signed"); }
bool is_sparse(const Line& l) { return l.output.ends_with("sparse"); }
/// Dense, with nearest triangles.
bool has_nearest(const Line& l) { return l.output == "nearest" || l.output == "beside"; }

Times measure(const Line& l, const Mesh& mesh, FieldOnDevice& field) {
  std::vector<float> values;
  if (l.output == "host" || l.output == "download")
    values.resize(static_cast<std::size_t>(field.task().grid.sample_count()));
  StreamClock clock;
  if (l.output == "graph") {
    Recorded recorded([&](Stream stream) { field.enqueue(stream); });
    return repeated([&] {
      clock.start(recorded.stream());
      recorded.play();
      return clock.stop(recorded.stream());
    });
  }
  if (l.output == "host")
    return repeated([&] {
      return on_host([&] {
        field.upload(mesh);
        field.enqueue(nullptr);
        field.download(values);
      });
    });
  if (l.output == "upload") return repeated([&] { return on_host([&] { field.upload(mesh); }); });
  if (l.output == "download") return repeated([&] { return on_host([&] { field.download(values); }); });
  if (l.output == "counting") field.take_entries_away();
  const Part* const part = find_part(l.output);
  const bool is_field = l.output == "dense" || l.output == "sparse" || is_signed(l) || has_nearest(l);
  if (!part && l.output != "counting" && !is_field) throw Error(ErrorCode::usage, "no output '" + l.output + "'");
  const std::int64_t floats = l.output == "beside" ? 3 * field.task().grid.sample_count() : 0;
  const Memory beside(8 * floats);
  Task task = field.task();
  if (floats != 0)
    task.sidecars.closest_point = beside.as<float>(), task.sidecars.gradient = beside.as<float>() + floats;
  return repeated([&] {
    clock.start(nullptr);
    if (part)
      part->enqueue(field.task(), field.workspace(), field.workspace_bytes(), nullptr);
    else
      STANDOFF_PLATFORM::enqueue(task, field.workspace(), field.workspace_bytes(), nullptr);
    return clock.stop(nullptr);
  });
}

/// From host memory to a field there.
Times measure_compute(const Mesh& mesh, const Grid& grid, double thickness, Method method) {
  return repeated([&] {
    return on_host([&] {
      DistanceField field(grid, thickness);
      Sink sink(field);
      const ComputeOptions options;
      ProgressMeter progress(options.progress);
      STANDOFF_PLATFORM::run(method, {mesh, {}, grid, thickness, 0, Simd::automatic, progress}, sink);
    });
  });
}

void print(const Line& l, std::size_t triangles, double thickness, const Times& t, const Outcome& outcome,
           std::int64_t workspace_bytes, double written) {
  std::printf("%s,%s,%zu,%s,%s,%lldx%lldx%lld,%g,%.6f,%.6f,%d,%llu,%llu,%llu,%.1f,%.1f,%s,%s\n", l.table.c_str(),
              l.scene.c_str(), triangles, l.method.c_str(), l.output.c_str(), static_cast<long long>(l.size.x),
              static_cast<long long>(l.size.y), static_cast<long long>(l.size.z), thickness, t.median, t.least, t.runs,
              outcome.samples_examined, outcome.samples_band, outcome.needed_entries,
              static_cast<double>(workspace_bytes) / (1 << 20), written / t.median / 1e6, l.seconds_2008.c_str(),
              l.at_most_ms.c_str());
  std::fflush(stdout);
}

/// Many meshes at once, or the same one after the other.
void run_many(const Line& l, std::int64_t count, bool one_by_one) {
  const double thickness = std::stod(l.thickness);
  const testing::MeshBatch meshes = many(l, count, thickness);
  BatchOnDevice batch(meshes, l.size, false);
  const Outcome total = batch.run();
  const std::vector<Task> tasks = one_by_one ? batch.single_tasks() : std::vector<Task>();
  if (one_by_one) batch.make_room_for(tasks);
  if (profiles) {
    const Profiled watched;
    batch.enqueue(nullptr);
    batch.outcomes();  // waits
    return;
  }
  StreamClock clock;
  const Times t = repeated([&] {
    clock.start(nullptr);
    if (one_by_one)
      STANDOFF_PLATFORM::enqueue(std::span<const Task>(tasks), batch.workspace(), batch.workspace_bytes(), nullptr);
    else
      batch.enqueue(nullptr);
    return clock.stop(nullptr);
  });
  for (const Outcome& outcome : batch.outcomes()) cuda::check(outcome, batch.task());
  print(l, meshes.triangles.size(), thickness, t, total, batch.workspace_bytes(),
        4.0 * static_cast<double>(count * l.size.count()));
}

void profile(FieldOnDevice& field) {
  const Profiled watched;
  field.enqueue(nullptr);
  field.outcome();  // waits
}

void run(const Line& l) {
  if (const std::int64_t count = number_behind("batch_", l.output)) return run_many(l, count, false);
  if (const std::int64_t count = number_behind("singles_", l.output)) return run_many(l, count, true);
  const Mesh mesh = placed(l, l.scene, l.triangles);
  const Vec3 counts{double(l.size.x), double(l.size.y), double(l.size.z)}, spacing = l.extent / counts;
  const Grid grid{l.size, 0.5 * spacing, spacing};
  const double thickness = l.thickness == "inf" ? std::numeric_limits<double>::infinity() : std::stod(l.thickness);
  const Method method = l.method == "thesis" ? Method::thesis : Method::tiles;
  FieldOnDevice field(mesh, grid, thickness, method, is_sparse(l) ? Layout::sparse : Layout::dense, has_nearest(l),
                      {.method = is_signed(l) ? SignMethod::winding : SignMethod::none});
  const Outcome outcome = field.run();
  if (profiles) return profile(field);
  if (!export_folder.empty())
    return write_peer_file(export_folder + "/" + l.scene + "-" + l.thickness + "-" + std::to_string(l.size.x) + ".bin",
                           mesh, grid, thickness, field.values());
  const std::int64_t workspace = field.workspace_bytes();
  const Times t = l.output == "compute" ? measure_compute(mesh, grid, thickness, method) : measure(l, mesh, field);
  double written = 4.0 * static_cast<double>(is_sparse(l) ? outcome.needed_slots * kTileSamples : grid.sample_count());
  if (l.output == "upload") written = static_cast<double>(24 * mesh.vertices.size() + 12 * mesh.triangles.size());
  print(l, mesh.triangles.size(), thickness, t, outcome, workspace, written);
}

}  // namespace
}  // namespace standoff::STANDOFF_PLATFORM

int main(int argc, char** argv) {
  using namespace standoff::STANDOFF_PLATFORM;
  bool with_names = true;
  for (int n = 1; n < argc; ++n) {
    const std::string option = argv[n];
    if (option == "--once") least_runs = most_runs = 1;
    if (option == "--continue") with_names = false;
    if (option == "--profile") profiles = true;
    if (option == "--export" && n + 1 < argc) export_folder = argv[++n];
  }
  if (export_folder.empty() && with_names && !profiles) {
    std::puts(
        "table,scene,triangles,method,output,grid,thickness,median_ms,least_ms,runs,samples_examined,samples_band,"
        "list_entries,workspace_mib,written_gb_per_s,seconds_2008,at_most_ms");
    std::fflush(stdout);
  }
  int failed = 0;
  for (Line line; read(line);) {
    try {
      run(line);
    } catch (const standoff::Error& error) {
      std::fprintf(stderr, "measure: %s %s: %s\n", line.table.c_str(), line.scene.c_str(), error.what());
      failed = static_cast<int>(error.code());
      if (error.code() == standoff::ErrorCode::device) break;  // most such errors stay until the program ends
    } catch (const std::exception& error) {
      std::fprintf(stderr, "measure: %s %s: %s\n", line.table.c_str(), line.scene.c_str(), error.what());
      failed = 1;
    }
  }
  return failed;
}
