// SPDX-License-Identifier: Apache-2.0
// Execution::simd chooses the kernels of queries, and no bit of an answer depends on it.
#include <gtest/gtest.h>

#include "collision/collide.h"
#include "collision/sweep.h"
#include "simd/dispatch.h"
#include "tests/collision/bodies.h"
#include "tests/collision/expect_same.h"
#include "tests/support/expect_error.h"

namespace standoff {
namespace {

using namespace standoff::testing;

class SimdOfQueries : public ::testing::TestWithParam<Simd> {
 protected:
  SimdOfQueries() {
    Random random(9);
    for (int n = 0; n < 150; ++n) poses_.push_back(random_pose(random, 1.5));
    for (std::size_t n = 0; n + 1 < poses_.size(); ++n) motions_.push_back({poses_[n], poses_[n + 1], {0.1, 0.2, 0.3}});
  }
  const Execution with_{.simd = GetParam()};
  const Body a_{random_soup(1, 400, 1, 0.3)}, b_{ball_mesh(0.4, 3)};
  std::vector<Pose> poses_;
  std::vector<RigidMotion> motions_;
};

// Calls without an Execution take the best set.
TEST_P(SimdOfQueries, GivesTheSameBits) {
  if (!processor_has(GetParam())) GTEST_SKIP() << "this processor lacks the set";
  const CollideOptions near{.margin = 0.1}, certified{.margin = 0.1, .mode = CollideMode::certified};
  const ContactOptions few{.most = 5, .margin = 0.05};
  const auto hits = collide_all(a_, {}, b_, poses_, near, with_).results;
  const auto verdicts = collide_all(a_, {}, b_, poses_, certified, with_).results;
  const auto distances = distance_all(a_, {}, b_, poses_, {}, with_).results;
  const auto bounds = distance_all(a_, {}, b_, poses_, {.max_steps = 60}, with_).results;
  const auto contact = contacts_all(a_, {}, b_, poses_, few, with_).results;
  const auto swept = sweep_all(a_, {}, b_, motions_, {}, with_).results;
  for (std::size_t n = 0; n < poses_.size(); ++n) {
    SCOPED_TRACE("pose " + std::to_string(n));
    expect_same(hits[n], collide(a_, {}, b_, poses_[n], near));
    expect_same(verdicts[n], collide(a_, {}, b_, poses_[n], certified));
    expect_same(distances[n], distance(a_, {}, b_, poses_[n]));
    expect_same(bounds[n], distance(a_, {}, b_, poses_[n], {.max_steps = 60}));
    expect_same(contact[n], contacts(a_, {}, b_, poses_[n], few));
    if (n < motions_.size()) expect_same(swept[n], sweep(a_, {}, b_, motions_[n]));
  }
}

TEST_P(SimdOfQueries, IsAnErrorWhereTheProcessorLacksIt) {
  if (processor_has(GetParam())) GTEST_SKIP() << "this processor has the set";
  const std::string lacks = ": this processor lacks the instruction set asked for; use automatic";
  expect_error([&] { collide_all(a_, {}, b_, poses_, {}, with_); }, ErrorCode::usage, "collide" + lacks);
  expect_error([&] { distance_all(a_, {}, b_, poses_, {}, with_); }, ErrorCode::usage, "distance" + lacks);
  expect_error([&] { contacts_all(a_, {}, b_, poses_, {}, with_); }, ErrorCode::usage, "contacts" + lacks);
  expect_error([&] { sweep_all(a_, {}, b_, motions_, {}, with_); }, ErrorCode::usage, "sweep" + lacks);
}

INSTANTIATE_TEST_SUITE_P(Sets, SimdOfQueries, ::testing::Values(Simd::portable, Simd::avx2, Simd::avx512));

// Kernels that count their calls. Nothing else shows which set was used, for all give the same bits.
int calls;
void counted_gaps(const collision::FieldView& f, const FloatTransform& t, const collision::Sphere16& s, float enough,
                  float* gap) {
  ++calls;
  collision::best_kernels().gaps(f, t, s, enough, gap);
}
void counted_obb_free_times(const collision::Obb16& boxes, const collision::DoubleObb& box, bool sixteen_move,
                            const collision::RigidVelocity& velocity, double keep, double enough, double* time) {
  ++calls;
  collision::best_kernels().obb_free_times(boxes, box, sixteen_move, velocity, keep, enough, time);
}

TEST(Simd, QueriesUseTheKernelsOfTheirPair) {
  collision::Kernels counting = collision::best_kernels();
  counting.gaps = counted_gaps;
  counting.obb_free_times = counted_obb_free_times;
  const Body a(ball_mesh(1, 6)), b(ball_mesh(0.5, 6));
  const Pose near = moved({1.6, 0, 0});
  const collision::QueryPair pair(a, {}, b, near, counting);
  const auto used = [](auto query) {
    calls = 0;
    query();
    return calls > 0;
  };
  EXPECT_TRUE(used([&] { collision::find_intersecting_pair(pair, 0.2); }));
  EXPECT_TRUE(used([&] { collision::certify(pair, 0.2); }));
  EXPECT_TRUE(used([&] {
    const collision::AxisAngleMotion path({near, {}, {}});
    collision::Steps unlimited(0);
    collision::first_contact(collision::QueryPair(a, {}, b, near, counting), path, 1e-3, unlimited);
  }));
}

TEST(Simd, ASetHasItsOwnKernels) {
  const std::pair<Simd, const char*> sets[] = {
      {Simd::portable, "portable"}, {Simd::avx2, "avx2"}, {Simd::avx512, "avx512"}};
  for (const auto& [set, name] : sets) {
    if (!processor_has(set)) continue;
    EXPECT_STREQ(collision::kernels_for(set, "").name, name);
  }
}

}  // namespace
}  // namespace standoff
