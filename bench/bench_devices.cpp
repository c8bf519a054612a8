// SPDX-License-Identifier: Apache-2.0
// The GPU beside the CPU, from host memory to host memory, as callers of compute(), MeshQuery, collide_all() and
// distance_all() see them: from which size on is the GPU worth it? Writes a CSV line for each job: medians of both in
// ms. The answers are compared. bench_devices [--once]   --once: each runs once, on the emulated GPU where there is
// none, to try it
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include "bench/conforming.h"
#include "scenes/scenes.h"
#include "standoff/collision.h"
#include "standoff/compute.h"
#include "standoff/cuda.h"
#include "standoff/points.h"
#include "standoff/testing/emulation.h"

namespace standoff {
namespace {

Backend gpu = Backend::cuda;
bool once = false;

/// The median of some runs after the first one, within a second; ms.
double median_ms(const std::function<void()>& work) {
  const auto timed = [&] {
    const auto began = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
  };
  std::vector<double> all{timed()};
  if (!once) all.clear();
  double total = 0;
  while (!once && (all.size() < 3 || (all.size() < 30 && total < 1000))) {
    all.push_back(timed());
    total += all.back();
  }
  std::sort(all.begin(), all.end());
  return all[all.size() / 2];
}

/// A line; `run` does the work on a backend, `same` says whether both answers were equal.
void measure(const char* work, const std::string& scene, const std::string& size,
             const std::function<void(Backend)>& run, const std::function<bool()>& same) {
  const double cpu = median_ms([&] { run(Backend::cpu); });
  const double cuda = median_ms([&] { run(gpu); });
  std::printf("%s,%s,%s,%.3f,%.3f,%.2f,%s\n", work, scene.c_str(), size.c_str(), cpu, cuda, cpu / cuda,
              same() ? "same" : "DIFFERENT");
  std::fflush(stdout);
}

void measure_field(const std::string& scene, std::int64_t triangles, std::int64_t side, double spacings) {
  const Mesh mesh = scenes::make(scene, triangles);
  const Grid grid = fit_resolution(bounds(mesh), side, {.length = spacings < 8 ? spacings : 2.0, .least_samples = 0});
  DistanceField of_cpu, of_gpu;
  measure(
      "field", scene,
      std::to_string(mesh.triangles.size()) + "@" + std::to_string(side) + "/" +
          std::to_string(static_cast<int>(spacings)),
      [&](Backend backend) {
        ComputeOptions options{.sign = {SignMethod::none}, .execution = {.backend = backend}, .hash_mesh = false};
        (backend == Backend::cpu ? of_cpu : of_gpu) = compute(mesh, grid, spacings * grid.max_spacing(), options).field;
      },
      [&] { return of_cpu.to_dense() == of_gpu.to_dense(); });
}

void measure_points(const std::string& scene, std::int64_t triangles, int count) {
  const Mesh mesh = scenes::make(scene, triangles);
  const MeshQuery query(mesh, {.sign = {SignMethod::none}});
  const Box box = bounds(mesh);
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n) {  // the additive recurrence of three irrational numbers
    const auto at = [n](double step) { return n * step - static_cast<double>(static_cast<std::int64_t>(n * step)); };
    points.push_back(box.min + box.extent() * Vec3{at(0.8191725134), at(0.6710436067), at(0.5497004779)});
  }
  std::vector<double> of_cpu(points.size()), of_gpu(points.size());
  measure(
      "distances", scene, std::to_string(mesh.triangles.size()) + "@" + std::to_string(count),
      [&](Backend backend) {
        query.distances(points, backend == Backend::cpu ? of_cpu : of_gpu, {.execution = {.backend = backend}});
      },
      [&] { return of_cpu == of_gpu; });
}

void measure_collisions(int count) {
  const Mesh maze_mesh = scenes::make("labyrinth", 200000);
  const Body maze(maze_mesh), fly(scenes::make("fly"));
  const Box box = bounds(maze_mesh);
  std::vector<Pose> poses;
  for (int n = 0; n < count; ++n) {
    const auto at = [n](double step) { return n * step - static_cast<double>(static_cast<std::int64_t>(n * step)); };
    Pose pose{.translation = box.min + box.extent() * Vec3{at(0.8191725134), at(0.6710436067), at(0.5497004779)}};
    poses.push_back(pose);
  }
  BatchResult<CollisionResult> of_cpu, of_gpu;
  measure(
      "collide", "labyrinth+fly", std::to_string(count),
      [&](Backend backend) {
        (backend == Backend::cpu ? of_cpu : of_gpu) = collide_all(maze, {}, fly, poses, {}, {.backend = backend});
      },
      [&] {
        return std::ranges::equal(of_cpu.results, of_gpu.results, {}, &CollisionResult::hit, &CollisionResult::hit);
      });
}

void measure_distances(const std::string& name, const Body& a, const Body& b, const std::vector<Pose>& poses) {
  BatchResult<DistanceResult> of_cpu, of_gpu;
  const auto nearest = [](const DistanceResult& r) { return std::tuple(r.upper, r.triangle_a, r.triangle_b); };
  measure(
      "distance", name, std::to_string(poses.size()),
      [&](Backend backend) {
        (backend == Backend::cpu ? of_cpu : of_gpu) = distance_all(a, {}, b, poses, {}, {.backend = backend});
      },
      [&] { return std::ranges::equal(of_cpu.results, of_gpu.results, {}, nearest, nearest); });
}

// Beside each other, at many distances, each pose turned.
void measure_distances_around(int count) {
  const Body catapult(scenes::make("catapult")), bender(scenes::make("bender"));
  std::vector<Pose> poses;
  for (int n = 0; n < count; ++n)
    poses.push_back(make_pose({1, 2, 3}, 0.01 * n, catapult.bounds().extent() * (0.6 + 0.9 * (n % 100) / 100)));
  measure_distances("catapult+bender", catapult, bender, poses);
}

// A single pose of surfaces that run side by side.
void measure_distance_of_shells(std::int64_t triangles) {
  measure_distances("shells", Body(bench::make_conforming("shell:1", triangles)),
                    Body(bench::make_conforming("shell:0.97", triangles)), {make_pose({1, 2, 3}, 0.5, {})});
}

int run() {
  std::puts("work,scene,size,cpu_ms,gpu_ms,ratio,answers");
  if (once) {
    measure_field("fly", 0, 20, 2);
    measure_points("fly", 0, 100);
    measure_collisions(20);
    measure_distances_around(5);
    measure_distance_of_shells(1000);
    return 0;
  }
  for (const std::int64_t side : {16, 32, 48, 64, 96, 128, 192, 256}) measure_field("machine_2", 20000, side, 2);
  for (const std::int64_t side : {16, 32, 64, 96, 128}) measure_field("machine_2", 20000, side, 1e6);
  for (const std::int64_t side : {128, 410}) measure_field("factory", 0, side, 2);
  measure_field("factory", 0, 410, 8);
  measure_field("terrain", 1000000, 512, 2);
  measure_field("terrain", 1000000, 256, 1e6);
  for (const int count : {1000, 10'000, 30'000, 100'000, 1'000'000, 4'000'000}) measure_points("factory", 0, count);
  for (const int count : {10'000, 100'000, 1'000'000}) measure_points("machine_2", 20000, count);
  for (const int count : {100, 1000, 3000, 10'000, 100'000, 1'000'000}) measure_collisions(count);
  for (const int count : {1, 100, 1000, 10'000, 100'000}) measure_distances_around(count);
  for (const int triangles : {70'000, 1'000'000}) measure_distance_of_shells(triangles);
  return 0;
}

}  // namespace
}  // namespace standoff

int main(int argc, char** argv) {
  using namespace standoff;
  once = argc > 1 && std::string(argv[1]) == "--once";
  if (cuda::devices().empty()) {
    std::fprintf(stderr, "bench_devices: %s\n", cuda::why_no_device().c_str());
    if (!once) return 6;
    gpu = testing::kEmulated;
  }
  try {
    return run();
  } catch (const Error& error) {
    std::fprintf(stderr, "bench_devices: %s\n", error.what());
    return static_cast<int>(error.code());
  }
}
