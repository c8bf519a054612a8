// SPDX-License-Identifier: Apache-2.0
// Slivers, of every height from a tenth of their length to the rounding of doubles, against exact answers. A triangle's
// computed normal is off by more, and the separating axes with it, the thinner the triangle is: a test that took it to
// be perpendicular to its triangle missed up to 1.4 % of these pairs that touch.
//
// STANDOFF_CHECK_SLIVERS: pairs of each height, a third of them touching by construction; STANDOFF_CHECK_SEED: the
// first body's seed.
// labels: none
#include <gtest/gtest.h>

#include "standoff/testing/emulation.h"
#include "tests/collision/zoo/ask.h"
#include "tests/collision/zoo/check_touch.h"
#include "tests/collision/zoo/slivers.h"

namespace standoff {
namespace {

using namespace standoff::testing;

// Fields decide little here: coarse ones are made fast.
const BodyOptions kCoarse{.spacing = 0.5, .execution = {.threads = 1}};

// Pairs of a body with its partner, and in how many poses, each time with other rounding: many cost less each, and few
// have less slack to hide in, which grows with the body.
constexpr struct { int pairs, poses; } kBodies[] = {{1, 10}, {1, 10}, {8, 10}, {64, 10}, {1000, 2}};

// The bodies as they are, both turned, and one of them moved by little.
std::pair<Pose, Pose> poses(Random& random, int n) {
  if (n == 0) return {};
  if (n % 2 == 1) {
    const Pose turned = random_pose(random, 10);
    return {turned, turned};
  }
  return {{}, moved(direction(random) * log_between(random, 1e-17, 1e-2))};
}

// What a GPU's kernels say, emulated, of the second body at each of the poses.
void check_emulated(const Body& a, const Body& b, const std::vector<Pose>& poses, Findings& found) {
  const Execution emulated{.threads = 1, .backend = testing::kEmulated};
  const auto answers = collide_all(a, {}, b, poses, {}, emulated).results;
  for (std::size_t n = 0; n < poses.size(); ++n) {
    const bool expected = !touching_pairs({a.mesh(), {}}, {b.mesh(), poses[n]}).empty();
    found.count("emulated poses");
    found.expect(answers[n].hit() || !expected, "collide: emulated, free, but they touch");
    found.expect(!answers[n].hit() || expected, "collide: emulated, hit, but they do not touch");
  }
}

class Slivers : public ::testing::TestWithParam<int> {};

TEST_P(Slivers, TouchWhereTheyDo) {
  const double ratio = std::pow(10, -GetParam());
  const long wanted = from_environment("STANDOFF_CHECK_SLIVERS", 20'000);
  const unsigned first = static_cast<unsigned>(from_environment("STANDOFF_CHECK_SEED", 1));
  Findings found;
  long pairs = 0;
  for (unsigned seed = first; pairs < wanted; ++seed) {
    const auto& [count, poses_of_a_body] = kBodies[seed % std::size(kBodies)];
    const SliverBodies bodies = sliver_bodies(seed, ratio, count);
    const Body a(bodies.a, kCoarse), b(bodies.b, kCoarse);
    Random random(seed);
    std::vector<Pose> of_b;
    for (int n = 0; n < poses_of_a_body; ++n, pairs += count) {
      found.at(seed, n);
      const auto [pose_a, pose_b] = poses(random, n);
      const PlacedPair at(a, pose_a, b, pose_b);
      check_contacts(at, false, found);
      check_collide(at, found);
      if (pose_a == Pose{}) of_b.push_back(pose_b);
    }
    if (count == 1) check_emulated(a, b, of_b, found);
  }
  std::printf("height/length 1e-%d: %ld pairs of slivers\n", GetParam(), pairs);
  found.expect_none();
  const long touching = found.counted("pairs of triangles that touch");
  EXPECT_GT(touching, pairs / 20);
  EXPECT_LT(touching, pairs * 19 / 20);
}

INSTANTIATE_TEST_SUITE_P(Heights, Slivers, ::testing::Range(1, 16));

}  // namespace
}  // namespace standoff
