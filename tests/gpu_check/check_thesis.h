// SPDX-License-Identifier: Apache-2.0
// gpu-check, the thesis's animation: Algorithm 2 on this machine's GPU against the CPU's, with fields that were copied
// there and with fields that are computed there at each pose, bit by bit; and how many steps a second that makes.
#pragma once

#include <bit>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "standoff/thesis.h"
#include "tests/support/random_mesh.h"

namespace standoff {

class ThesisCheck {
 public:
  explicit ThesisCheck(Backend backend) : gpu_{.backend = backend} {}

  /// Prints a line per case and, if asked to, the rates; returns how many were wrong of how many.
  std::pair<int, int> run(bool quick, int poses) {
    compare("soup", testing::random_soup(95, 300, 1, 0.2), testing::random_soup(96, 60, 0.4, 0.2), 0.3, poses);
    if (!quick) {
      compare("on a lattice", testing::nasty_soup(97, 40, 2), testing::nasty_soup(98, 20, 1), 0.7, poses);
      compare("labyrinth and fly", scenes::make("labyrinth", 20000), scenes::make("fly", 2000), 2, poses);
      for (const double e : {2.0, 4.0, 8.0}) tell_rate(e);
    }
    return {wrong_, count_};
  }

 private:
  static DistanceField field_of(const Mesh& mesh, double thickness, double e) {
    ComputeOptions options;
    options.sign = {SignMethod::none};
    options.execution.backend = Backend::cpu;
    return compute(mesh, minimum_grid(bounds(mesh), thickness, e), thickness, options).field;
  }

  static std::vector<Pose> poses_in(const Mesh& resting, int count) {
    testing::Random random(99);
    const Box box = bounds(resting);
    std::vector<Pose> poses;
    for (int n = 0; n < count; ++n)
      poses.push_back(make_pose(random.in_cube(1) + Vec3{0, 0, 1e-3}, random.between(0, 6.28),
                                box.center() + box.extent() * random.in_cube(0.8)));
    return poses;
  }

  // The answers for one pose, as numbers that are equal only where their bits are.
  static std::vector<std::uint64_t> answers(const ThesisField& a, const ThesisField& b, const Pose& pose,
                                            double threshold) {
    const ThesisCollisionResult result = collide_thesis(a, {}, b, pose, threshold);
    return {result.hit, static_cast<std::uint64_t>(result.samples),
            std::bit_cast<std::uint64_t>(thesis_sum(a, {}, b, pose))};
  }

  void compare(const char* name, const Mesh& resting, const Mesh& moving, double thickness, int count) {
    const DistanceField of_resting = field_of(resting, thickness, 3), of_moving = field_of(moving, thickness, 3);
    const ThesisField a(of_resting, cpu_), b(of_moving, cpu_), gpu_a(of_resting, gpu_), gpu_b(of_moving, gpu_);
    const MinimumField anew(moving, thickness, 3, 0, cpu_), gpu_anew(moving, thickness, 3, 0, gpu_);
    const double threshold = a.grid().max_spacing() / 4;
    int differ = 0, hits = 0;
    for (const Pose& pose : poses_in(resting, count)) {
      const auto expected = answers(a, b, pose, threshold);
      const ThesisField there = anew.at(pose), gpu_there = gpu_anew.at(pose);
      const bool same = answers(gpu_a, gpu_b, pose, threshold) == expected && gpu_there.grid() == there.grid() &&
                        answers(gpu_a, gpu_there, {}, threshold) == answers(a, there, {}, threshold);
      differ += !same;
      hits += expected[0] != 0;
    }
    std::printf("%-6s thesis  %-18s %d of %d differ, %d hits\n", differ == 0 ? "ok" : "WRONG", name, differ, count,
                hits);
    std::fflush(stdout);
    wrong_ += differ != 0;
    ++count_;
  }

  // Steps a second of the thesis's animation, with its numbers of triangles.
  static double rate(const ThesisField& labyrinth, const MinimumField& fly, const std::vector<Pose>& poses) {
    const auto step = [&](const Pose& pose) { collide_thesis(labyrinth, {}, fly.at(pose), {}, 1); };
    step(poses[0]);
    const auto start = std::chrono::steady_clock::now();
    for (const Pose& pose : poses) step(pose);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    return static_cast<double>(poses.size()) / seconds.count();
  }

  void tell_rate(double e) {
    const Mesh labyrinth = scenes::make("labyrinth"), fly = scenes::make("fly");
    const DistanceField field = field_of(labyrinth, 2, e);
    const double on_gpu = rate(ThesisField(field, gpu_), MinimumField(fly, 2, e, 0, gpu_),
                               poses_in(labyrinth, gpu_.backend == Backend::cuda ? 1000 : 2)),
                 on_cpu = rate(ThesisField(field, cpu_), MinimumField(fly, 2, e, 0, cpu_), poses_in(labyrinth, 10));
    std::printf("ok     thesis  recomputed, e = %g: %.0f steps a second on %s, %.0f on the CPU\n", e, on_gpu,
                name_of(gpu_.backend), on_cpu);
    std::fflush(stdout);
  }

  Execution cpu_{.backend = Backend::cpu}, gpu_;
  int wrong_ = 0, count_ = 0;
};

}  // namespace standoff
