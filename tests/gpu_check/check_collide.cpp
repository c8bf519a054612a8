// SPDX-License-Identifier: Apache-2.0
// gpu-check, collisions and points: poses decided, distances measured, motions swept and nearest triangles found on
// this machine's GPU, and the thesis's animation, against the CPU's answers.
//
// check_collide [--quick] [--emulated]: prints a line per case and how many were wrong; exit code 0 where none was.
// --emulated checks the check: the emulation takes the GPU's part, and no GPU is needed.
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "bench/conforming.h"
#include "scenes/scenes.h"
#include "standoff/collision.h"
#include "standoff/error.h"
#include "standoff/testing/emulation.h"
#include "tests/gpu_check/check_points.h"
#include "tests/gpu_check/check_thesis.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

struct Case {
  std::string name;
  Mesh a, b;
  Pose pose_a;
  double margin;
  bool on_lattice;  // whole translations: triangles that touch exactly
};

Pose random_pose(testing::Random& random) {
  return make_pose(random.in_cube(1) + Vec3{0, 0, 1e-3}, random.between(0, 6.28), {});
}

std::vector<Pose> poses_for(const Case& c, int count) {
  testing::Random random(81);
  const Box box = bounds(c.a);
  const Vec3 half = 0.5 * box.extent() + Vec3{1, 1, 1} * (0.3 * length(bounds(c.b).extent()));
  std::vector<Pose> poses;
  for (int n = 0; n < count; ++n) {
    Pose pose = c.on_lattice ? Pose{} : random_pose(random);
    const Vec3 at = box.center() + random.in_cube(1) * half;
    pose.translation = c.on_lattice ? Vec3{std::round(at.x), std::round(at.y), std::round(at.z)} : apply(c.pose_a, at);
    poses.push_back(pose);
  }
  return poses;
}

std::vector<Case> cases(bool quick) {
  std::vector<Case> all;
  const Mesh soup = testing::random_soup(82, 300, 1, 0.2), nasty = testing::nasty_soup(83, 40, 2);
  all.push_back({"soup", soup, testing::random_soup(84, 60, 0.4, 0.2), {}, 0, false});
  all.push_back({"on a lattice", nasty, testing::nasty_soup(85, 20, 2), {}, 0, true});
  if (quick) return all;
  testing::Random random(86);
  Pose moved = random_pose(random);
  moved.translation = {30, -7, 2};
  all.push_back({"both moved", soup, testing::random_soup(87, 60, 0.4, 0.2), moved, 0, false});
  all.push_back({"b the larger", testing::random_soup(88, 60, 0.4, 0.2), soup, moved, 0, false});
  all.push_back({"within a margin", soup, testing::random_soup(89, 60, 0.4, 0.2), moved, 0.1, false});
  all.push_back({"labyrinth and fly", scenes::make("labyrinth", 20000), scenes::make("fly", 2000), {}, 0, false});
  return all;
}

int tell(const char* query, const Case& c, std::size_t count, int wrong, int hits, const BatchReport& report) {
  std::printf("%-6s %-8s %-18s %d of %zu differ, %d hits; decided by %s: %lld, undecided: %lld, overflows: %lld\n",
              wrong == 0 ? "ok" : "WRONG", query, c.name.c_str(), wrong, count, hits, report.backend.c_str(),
              static_cast<long long>(report.on_device), static_cast<long long>(report.undecided),
              static_cast<long long>(report.overflowed));
  std::fflush(stdout);
  return wrong != 0;
}

int run(const Case& c, Backend backend, int count) {
  const Body a(c.a), b(c.b);
  const std::vector<Pose> poses = poses_for(c, count);
  const auto [found, report] = collide_all(a, c.pose_a, b, poses, {.margin = c.margin}, {.backend = backend});
  const auto expected = collide_all(a, c.pose_a, b, poses, {.margin = c.margin}, {.backend = Backend::cpu}).results;
  int wrong = 0, hits = 0;
  for (std::size_t n = 0; n < poses.size(); ++n)
    wrong += found[n].verdict != expected[n].verdict, hits += expected[n].hit();
  return tell("collide", c, poses.size(), wrong, hits, report);
}

int compare_distances(const Case& c, const std::vector<Pose>& poses, Backend backend) {
  const Body a(c.a), b(c.b);
  const double limit = c.margin > 0 ? c.margin : std::numeric_limits<double>::infinity();
  const auto [found, report] = distance_all(a, c.pose_a, b, poses, {.limit = limit}, {.backend = backend});
  const auto expected = distance_all(a, c.pose_a, b, poses, {.limit = limit}, {.backend = Backend::cpu}).results;
  int wrong = 0, hits = 0;
  for (std::size_t n = 0; n < poses.size(); ++n) {
    const DistanceResult &f = found[n], &e = expected[n];
    wrong += f.lower != e.lower || f.upper != e.upper || f.point_a != e.point_a || f.point_b != e.point_b ||
             f.triangle_a != e.triangle_a || f.triangle_b != e.triangle_b;
    hits += e.upper == 0;
  }
  return tell("distance", c, poses.size(), wrong, hits, report);
}

int run_distances(const Case& c, Backend backend, int count) {
  std::vector<Pose> poses = poses_for(c, count);
  for (Pose& pose : poses)  // fewer that intersect
    pose.translation = pose.translation + (pose.translation - c.pose_a.translation);
  return compare_distances(c, poses, backend);
}

// Surfaces that run side by side: a single pose keeps all warps busy.
int run_shells(Backend backend, std::int64_t triangles) {
  const Case c{"nested shells",
               bench::make_conforming("shell:1", triangles),
               bench::make_conforming("shell:0.97", triangles),
               {},
               0,
               false};
  testing::Random random(91);
  std::vector<Pose> poses;
  for (int n = 0; n < 3; ++n) {
    poses.push_back(random_pose(random));
    poses.back().translation = random.in_cube(1e-3);
  }
  return compare_distances(c, poses, backend);
}

int run_sweeps(const Case& c, Backend backend, int count) {
  const Body a(c.a), b(c.b);
  testing::Random random(90);
  const double way = 0.2 * length(bounds(c.b).extent());
  std::vector<RigidMotion> motions;
  for (const Pose& from : poses_for(c, count)) {
    Pose to = compose(from, make_pose({1, 2, 3}, random.between(0, 0.5), {}));
    to.translation = from.translation + random.in_cube(way);
    motions.push_back({from, to, {}});
  }
  const auto [found, report] = sweep_all(a, c.pose_a, b, motions, {}, {.backend = backend});
  const auto expected = sweep_all(a, c.pose_a, b, motions, {}, {.backend = Backend::cpu}).results;
  int wrong = 0, hits = 0;
  for (std::size_t n = 0; n < motions.size(); ++n)
    wrong += found[n].hit != expected[n].hit || found[n].time != expected[n].time, hits += expected[n].hit;
  return tell("sweep", c, motions.size(), wrong, hits, report);
}

int run_all(bool quick, Backend backend) {
  int faults = 0, count = 0;
  for (const Case& c : cases(quick)) {
    const bool few = quick || backend == testing::kEmulated;
    faults += run(c, backend, few ? 300 : 20000) + run_sweeps(c, backend, few ? 100 : 5000) +
              run_distances(c, backend, few ? 100 : 5000);
    count += 3;
  }
  faults += run_shells(backend, quick || backend == testing::kEmulated ? 1000 : 70000);
  ++count;
  const auto [wrong, points] = check_points(quick, backend, quick || backend == testing::kEmulated ? 1000 : 200'000);
  faults += wrong;
  count += points;
  const auto [wrong_thesis, cases_of_thesis] =
      ThesisCheck(backend).run(quick, quick || backend == testing::kEmulated ? 100 : 2000);
  faults += wrong_thesis;
  count += cases_of_thesis;
  std::printf("%d of %d checks went wrong\n", faults, count);
  return faults == 0 ? 0 : 7;
}

}  // namespace
}  // namespace standoff

int main(int argc, char** argv) {
  bool quick = false;
  standoff::Backend backend = standoff::Backend::cuda;
  for (int n = 1; n < argc; ++n) {
    const std::string option = argv[n];
    if (option == "--quick") quick = true;
    if (option == "--emulated") backend = standoff::testing::kEmulated;
  }
  try {
    return standoff::run_all(quick, backend);
  } catch (const standoff::Error& error) {
    std::fprintf(stderr, "check_collide: error: %s\n", error.what());
    return static_cast<int>(error.code());
  }
}
