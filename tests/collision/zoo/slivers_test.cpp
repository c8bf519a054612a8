// Slivers, of every height from a tenth of their length to the rounding of doubles, against exact answers. A triangle's
// computed normal is off by more, and the separating axes with it, the thinner the triangle is: a test that takes
// it to be perpendicular to its triangle once missed a quarter of the pairs of slivers that touch.
//
// DIFI_CHECK_SLIVERS: pairs of each height; DIFI_CHECK_SEED: the first body's seed. 1000 pairs share a body and a
// query.
#include <gtest/gtest.h>

#include <string>

#include "difi/collision.h"
#include "tests/collision/zoo/ask.h"
#include "tests/collision/zoo/slivers.h"
#include "tests/collision/zoo/truth.h"

namespace difi {
namespace {

using namespace difi::testing;

const ModelOptions kCoarse{0.5, 1};  // fields decide little here: coarse ones are made fast

// Pairs of a body with its partner, and in how many poses, each time with other rounding: many cost less each, and few
// have less slack to hide in, which grows with the body.
constexpr struct { int pairs, poses; } kBodies[] = {{1, 100}, {8, 100}, {64, 100}, {1000, 10}};

struct Tally {
  long pairs = 0, touching = 0, missed = 0, invented = 0, repeated = 0, asymmetric = 0;
};

TrianglePairs sorted_pairs(const Contacts& found, bool turned) {
  TrianglePairs pairs;
  for (const ContactPoint& it : found.contacts)
    pairs.emplace_back(turned ? it.triangle_b : it.triangle_a, turned ? it.triangle_a : it.triangle_b);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

// Pairs of `some` that `others` lack.
TrianglePairs without(const TrianglePairs& some, const TrianglePairs& others) {
  TrianglePairs rest;
  std::set_difference(some.begin(), some.end(), others.begin(), others.end(), std::back_inserter(rest));
  return rest;
}

void print(const char* what, const Corners& p, const Corners& q) {
  std::printf("%s:\n", what);
  for (const Corners* t : {&p, &q})
    std::printf("  {{%a, %a, %a}, {%a, %a, %a}, {%a, %a, %a}}\n", (*t)[0].x, (*t)[0].y, (*t)[0].z, (*t)[1].x, (*t)[1].y,
                (*t)[1].z, (*t)[2].x, (*t)[2].y, (*t)[2].z);
}

// The bodies as they are, both turned, and one of them moved by little.
std::pair<Pose, Pose> poses(Random& random, int n) {
  if (n == 0) return {};
  if (n % 2 == 1) {
    const Pose turned = random_pose(random, 10);
    return {turned, turned};
  }
  return {{}, moved(direction(random) * log_between(random, 1e-17, 1e-2))};
}

void check(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b, Tally& tally) {
  const PlacedBody placed_a(a.mesh(), pose_a), placed_b(b.mesh(), pose_b);
  const TrianglePairs expected = touching_pairs(placed_a, placed_b);
  const ContactOptions all{.most = 1'000'000};
  const TrianglePairs found = sorted_pairs(contacts(a, pose_a, b, pose_b, all), false),
                      turned = sorted_pairs(contacts(b, pose_b, a, pose_a, all), true);
  const TrianglePairs missed = without(expected, found), invented = without(found, expected);
  const auto show = [&](const char* what, const TrianglePairs& pairs) {
    print(what, placed_a.triangle(pairs[0].first), placed_b.triangle(pairs[0].second));
  };
  if (!missed.empty() && tally.missed == 0) show("they touch, but contacts() lacks them", missed);
  if (!invented.empty() && tally.invented == 0) show("they do not touch, but contacts() has them", invented);
  tally.pairs += placed_a.size();
  tally.touching += static_cast<long>(expected.size());
  tally.missed += static_cast<long>(missed.size());
  tally.invented += static_cast<long>(invented.size());
  tally.repeated += std::adjacent_find(found.begin(), found.end()) != found.end();
  tally.asymmetric += static_cast<long>(without(found, turned).size() + without(turned, found).size());
}

class Slivers : public ::testing::TestWithParam<int> {};

TEST_P(Slivers, TouchWhereTheyDo) {
  const double ratio = std::pow(10, -GetParam());
  const long pairs = from_environment("DIFI_CHECK_SLIVERS", 20'000);
  const unsigned first = static_cast<unsigned>(from_environment("DIFI_CHECK_SEED", 1));
  Tally tally;
  for (unsigned seed = first; tally.pairs < pairs; ++seed) {
    const auto& [count, poses_of_a_body] = kBodies[seed % std::size(kBodies)];
    const SliverBodies bodies = sliver_bodies(seed, ratio, count);
    const CollisionModel a(bodies.a, kCoarse), b(bodies.b, kCoarse);
    Random random(seed);
    for (int n = 0; n < poses_of_a_body && tally.pairs < pairs; ++n) {
      const auto [pose_a, pose_b] = poses(random, n);
      check(a, pose_a, b, pose_b, tally);
    }
  }
  std::printf("height/length 1e-%d: %ld pairs, %ld touching, %ld missed, %ld invented, %ld asymmetric\n", GetParam(),
              tally.pairs, tally.touching, tally.missed, tally.invented, tally.asymmetric);
  EXPECT_EQ(tally.missed, 0);
  EXPECT_EQ(tally.invented, 0);
  EXPECT_EQ(tally.repeated, 0);
  EXPECT_EQ(tally.asymmetric, 0);
  EXPECT_GT(tally.touching, tally.pairs / 20);
  EXPECT_LT(tally.touching, tally.pairs * 19 / 20);
}

INSTANTIATE_TEST_SUITE_P(Heights, Slivers, ::testing::Range(1, 16));

}  // namespace
}  // namespace difi
