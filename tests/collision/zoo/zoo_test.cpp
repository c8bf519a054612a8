// SPDX-License-Identifier: Apache-2.0
// Bodies of the zoo, in millions of poses, motions and distances if so many are asked for, against exact answers.
//
// STANDOFF_CHECK_ZOO: poses; a tenth of them are asked for their distance too, a tenth for a sweep.
// STANDOFF_CHECK_SEED: the first pair of bodies'. What is printed of a wrong answer is the seed of its pair, and which
// of its poses it is: with these in STANDOFF_CHECK_SEED and STANDOFF_CHECK_POSE the bodies are written as zoo_a.obj and
// zoo_b.obj, and the poses as the program takes them.
#include <gtest/gtest.h>

#include "standoff/io.h"
#include "standoff/testing/emulation.h"
#include "tests/collision/zoo/animals.h"
#include "tests/collision/zoo/ask.h"
#include "tests/collision/zoo/check_distance.h"
#include "tests/collision/zoo/check_sweep.h"
#include "tests/collision/zoo/check_touch.h"

namespace standoff {
namespace {

using namespace standoff::testing;

constexpr int kPosesOfAPair = 100;
const Execution kEmulation{.threads = 1, .backend = testing::kEmulated};

// Mostly of few triangles, for which the whole truth is known soon; in units from 1e-12 to 1e12, like or unlike.
struct Herds {
  Mesh a, b;
  double size;
};
Mesh in_limits(const Mesh& mesh, double unit, Vec3 at) {
  const double size = longest(bounds(mesh));
  if (size * unit > 1e12) unit = 1e11 / size;
  if (size > 0 && size * unit < 1e-12) unit = 1e-11 / size;
  const Mesh placed = in_units(mesh, unit, at * std::min(unit, 1e7));
  // Far away rounding may leave less of it than is allowed.
  const double left = longest(bounds(placed));
  return left > 0 && left < 1e-12 ? in_units(mesh, unit, {}) : placed;
}
Herds herds(Random& random) {
  const auto count = [&] { return random.below(8) == 0 ? 40 : 1 + static_cast<int>(random.below(8)); };
  const double unit = random.below(2) ? 1 : std::pow(10, random.between(-11.5, 11.5));
  const double ratio = random.below(4) ? 1 : log_between(random, 1e-6, 1e6);
  const auto place = [&] { return random.below(4) ? Vec3{} : random.in_cube(1) * log_between(random, 1, 1e6); };
  Herds it;
  it.a = in_limits(herd(random, count()), unit, place());
  it.b = in_limits(herd(random, count()), std::clamp(unit * ratio, 1e-12, 1e12), place());
  it.size = std::max(longest(bounds(it.a)), longest(bounds(it.b)));
  if (it.size == 0) it.size = unit;
  return it;
}

// Coarse fields are made fast; some are finer, and decide more.
BodyOptions model_options(const Mesh& mesh, unsigned seed) {
  const double size = longest(bounds(mesh)), samples = seed % 16 == 5 ? 32 : 4;
  return {size > 0 ? size / samples : 0, {.threads = 1}};
}

Pose resting_pose(Random& random, double size) {
  Pose pose = any_rotation(random);
  switch (random.below(4)) {
    case 0:
      return {};
    case 1:
      pose.translation = rounded(random.in_cube(4)) * size;
      break;
    case 2:
      pose.translation = random.in_cube(size);
      break;
    default:
      pose.translation = random.in_cube(1) * std::min(1e14, size * log_between(random, 1, 1e9));
  }
  return pose;
}

// A motion that is at `pose` at time `meeting`.
RigidMotion motion_through(Random& random, const Pose& pose, double meeting, double size) {
  const Vec3 translation = direction(random) * (size * log_between(random, 1e-6, 1e3));
  RigidMotion motion{pose, pose, {}};
  motion.start.translation = pose.translation - translation * meeting;
  motion.end.translation = pose.translation + translation * (1 - meeting);
  return motion;
}

// --pose: a 3x4 matrix, row by row.
void print(const char* option, const Pose& pose) {
  std::printf("%s=", option);
  const double along[] = {pose.translation.x, pose.translation.y, pose.translation.z};
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 3; ++k) std::printf("%.17g,", pose.rotation[3 * row + k]);
    std::printf("%.17g%s", along[row], row < 2 ? "," : "\n");
  }
}
void show(const RigidMotion& motion, double tolerance) {
  print("--from", motion.start);
  print("--to", motion.end);
  std::printf("--center=%.17g,%.17g,%.17g --tolerance=%.17g\n", motion.center.x, motion.center.y, motion.center.z,
              tolerance);
}

void check_sweeps(const PlacedPair& at, double size, int n, Random& random, bool shown, Findings& found) {
  const double tolerance = size * log_between(random, 1e-15, 1e-2);
  if (n % 3 == 0) {  // no translation at all
    if (shown) show({at.pose_b, at.pose_b, {}}, tolerance);
    check_sweep(at, {at.pose_b, at.pose_b, {}}, tolerance, 0, random, found);
    return;
  }
  double meeting = random.between(0, 1);
  RigidMotion motion = motion_through(random, at.pose_b, meeting, size);
  if (n % 3 == 1) {  // turning into the pose
    const Pose turn = make_pose(direction(random), random.between(0, 3), {});
    motion.end = at.pose_b;
    motion.start.rotation = compose(turn, at.pose_b).rotation;
    motion.center = at.model_b.bounds().center();
    meeting = 1;
  }
  if (shown) show(motion, tolerance);
  const PlacedPair start(at.model_a, at.pose_a, at.model_b, motion.start);
  check_sweep(start, motion, tolerance, meeting, random, found);
}

// What a GPU's kernels say, emulated, where the same is promised.
void check_emulated(const Body& a, const Pose& pose_a, const Body& b, const std::vector<Pose>& poses, double size,
                    Findings& found) {
  for (const double margin : {0.0, 0.01 * size}) {
    const auto device = collide_all(a, pose_a, b, poses, {.margin = margin}, kEmulation).results;
    const auto cpu = collide_all(a, pose_a, b, poses, {.margin = margin}, {.threads = 1}).results;
    for (std::size_t n = 0; n < poses.size(); ++n) {
      found.count("emulated poses");
      found.expect(device[n].verdict == cpu[n].verdict, "collide: emulated, another answer");
      if (!device[n].hit() || margin > 0) continue;
      found.expect(touch(corners_at(a.mesh(), device[n].triangle_a, pose_a),
                         corners_at(b.mesh(), device[n].triangle_b, poses[n])),
                   "collide: emulated, the triangles it names do not touch");
    }
  }
  std::vector<RigidMotion> motions;
  for (std::size_t n = 1; n < poses.size(); n += 2) {
    motions.push_back({poses[n], poses[n], {}});
    motions.back().end.translation = poses[n].translation + (poses[n - 1].translation - poses[n].translation) * 0.1;
  }
  const auto device = sweep_all(a, pose_a, b, motions, {1e-4 * size}, kEmulation).results;
  const auto cpu = sweep_all(a, pose_a, b, motions, {1e-4 * size}, {.threads = 1}).results;
  for (std::size_t n = 0; n < motions.size(); ++n) {
    found.count("emulated sweeps");
    found.expect(device[n].hit == cpu[n].hit && device[n].time == cpu[n].time, "sweep: emulated, another answer");
  }
}

void show(const Herds& of, const Pose& pose_a, const Pose& pose_b) {
  write_mesh("zoo_a.obj", of.a);
  write_mesh("zoo_b.obj", of.b);
  print("--pose-a", pose_a);
  print("--pose", pose_b);
}

void check_pair(unsigned seed, Findings& found) {
  Random random(seed);
  const Herds of = herds(random);
  const Body a(of.a, model_options(of.a, seed)), b(of.b, model_options(of.b, seed));
  const Pose pose_a = resting_pose(random, of.size);
  std::vector<Pose> poses;
  for (int n = 0; n < kPosesOfAPair; ++n) {
    found.at(seed, n);
    const Pose pose_b = meeting_pose(random, of.a, pose_a, of.b, of.size);
    poses.push_back(pose_b);
    const bool shown = n == from_environment("STANDOFF_CHECK_POSE", -1);
    if (shown) show(of, pose_a, pose_b);
    const PlacedPair at(a, pose_a, b, pose_b);
    check_collide(at, found);
    if (n % 10 == 0) check_contacts(at, n % 20 == 0, found);
    if (n % 10 == 1) check_distance(at, found);
    if (n % 10 == 2) check_sweeps(at, of.size, n / 10, random, shown, found);
    if (n % 10 == 3) check_certified(at, n % 20 == 3 ? 0 : of.size * log_between(random, 1e-6, 1), found);
    if (n % 20 == 1) check_margin(at, at.distance() * random.between(0.5, 2), found);
    if (n % 20 == 11) check_margin(at, at.distance() * (1 + random.between(-1, 1) * 1e-3), found);
    if (n % 20 == 11) check_rough_distance(at, of.size * log_between(random, 1e-9, 1), found);
    if (n % 50 == 4) check_contacts_within(at, of.size * log_between(random, 1e-9, 0.3), found);
  }
  poses.resize(20);
  if (seed % 16 == 0) check_emulated(a, pose_a, b, poses, of.size, found);
}

TEST(Zoo, AnswersAreTrue) {
  const long poses = from_environment("STANDOFF_CHECK_ZOO", 20'000);
  const unsigned first = static_cast<unsigned>(from_environment("STANDOFF_CHECK_SEED", 1));
  Findings found;
  for (long n = 0; n < poses; n += kPosesOfAPair) {
    if (n > 0 && n % 1'000'000 == 0) std::fprintf(stderr, "%ld of %ld poses\n", n, poses);
    check_pair(first + static_cast<unsigned>(n / kPosesOfAPair), found);
  }
  found.expect_none();
  const long all = found.counted("poses"), touching = found.counted("poses that touch");
  EXPECT_GT(touching, all / 20);
  EXPECT_LT(touching, all * 19 / 20);
  if (all < 20'000) return;  // one pair alone need not have everything
  for (const char* what :
       {"straight sweeps whose whole path leads through", "sweeps that hit", "sweeps that touch at the start",
        "certified free", "margins", "pairs within a margin, and apart", "contacts with too little room",
        "rough distances", "emulated poses", "emulated sweeps"})
    EXPECT_GT(found.counted(what), 0) << what;
}

}  // namespace
}  // namespace standoff
