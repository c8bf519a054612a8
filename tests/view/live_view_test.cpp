// SPDX-License-Identifier: Apache-2.0
// A mesh whose field is computed anew: what is newer ends what is older, from any thread.
// labels: memory threads
#include "view/live/live_view.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/collision/bodies.h"

namespace standoff::view {
namespace {

using namespace standoff::testing;

LiveSettings coarse(std::int64_t samples = 24) {
  LiveSettings settings;
  settings.samples = samples;
  settings.sign.method = SignMethod::automatic;
  settings.execution.threads = 1;
  return settings;
}

const auto kStays = [] { return false; };

TEST(LiveView, ComputesWhatIsAsked) {
  LiveView view("ball", ball_mesh(1, 3), coarse(), 0);
  const auto whole = view.field(coarse(), kStays);
  ASSERT_TRUE(whole);
  LiveSettings thin = coarse();
  thin.thickness = 2;
  thin.thickness_in_samples = true;
  const auto band = view.field(thin, kStays);
  ASSERT_TRUE(band);
  EXPECT_LT(band->size(), whole->size());
  EXPECT_EQ(view.settings(), thin);
  const DistanceField expected =
      compute(ball_mesh(1, 3), fit_resolution({{-1, -1, -1}, {1, 1, 1}}, 24), kFullField, {.sign = coarse().sign})
          .field;
  EXPECT_EQ(whole, page_data(PageField{"ball", &expected}, PageOptions{.compression = 0}));
}

TEST(LiveView, NobodyWaitsForOldFields) {
  LiveView view("ball", ball_mesh(1, 3), coarse(), 0);
  EXPECT_FALSE(view.field(coarse(200), [] { return true; }));  // the page has gone
  for (const bool replaced : {false, true}) {
    const LiveSettings slow = coarse(180 + replaced);
    bool got = true;
    std::thread waiting([&] { got = view.field(slow, kStays).has_value(); });
    while (!(view.settings() == slow)) std::this_thread::yield();
    if (replaced)
      view.replace("other", ball_mesh(2, 2));
    else
      EXPECT_TRUE(view.field(coarse(16), kStays));
    waiting.join();
    EXPECT_FALSE(got);
  }
}

TEST(LiveView, AnotherMeshTakesItsPlace) {
  LiveView view("ball", ball_mesh(1, 3), coarse(), 0);
  EXPECT_NEAR(view.at({2, 0, 0}).closest.distance, 1, 0.02);
  EXPECT_LT(view.at({0.1, 0, 0}).closest.distance, 0);
  view.replace("large", ball_mesh(2, 3));
  EXPECT_EQ(view.subject().name, "large");
  EXPECT_EQ(view.subject().version, 2u);
  const auto [closest, gradient] = view.at({3, 0.001, 0});
  EXPECT_NEAR(closest.distance, 1, 0.04);
  EXPECT_NEAR(gradient.x, 1, 0.05);
  EXPECT_THROW(view.replace("none", Mesh{}), Error);
  EXPECT_EQ(view.subject().name, "large");
}

TEST(LiveView, ErrorsAreThePages) {
  LiveView view("ball", ball_mesh(1, 3), coarse(), 1000);
  try {
    view.field(coarse(), kStays);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::limit);
  }
  EXPECT_THROW(LiveView("none", Mesh{}, coarse(), 0), Error);
}

}  // namespace
}  // namespace standoff::view
