// SPDX-License-Identifier: Apache-2.0
#include "geometry/triangle_box.h"

#include <gtest/gtest.h>

namespace standoff {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(SampleRange, HoldsTheSamplesOnTheFacesOfTheBox) {
  const Grid grid{{10, 20, 30}, {1, -2, 3}, {0.5, 0.25, 2}};
  const SampleRange range = samples_in({{2, -1.9, 2.9}, {3, -1, 7.1}}, grid);
  EXPECT_EQ(range.begin, (Size3{2, 1, 0}));
  EXPECT_EQ(range.end, (Size3{5, 5, 3}));
  EXPECT_EQ(range.count(), 3 * 4 * 3);
}

TEST(SampleRange, IsClippedToTheGrid) {
  const Grid grid{{10, 20, 30}, {}, {1, 1, 1}};
  EXPECT_EQ(samples_in(Box{{0, 0, 0}, {1, 1, 1}}.grown(kInfinity), grid).count(), grid.sample_count());
  EXPECT_EQ(samples_in({{-1e300, -1e300, -1e300}, {1e300, 1e300, 1e300}}, grid).count(), grid.sample_count());
}

TEST(SampleRange, IsEmptyBesideTheGridAndBetweenSamples) {
  const Grid grid{{10, 10, 10}, {}, {1, 1, 1}};
  const Vec3 inside{5, 5, 5};
  for (const Vec3 corner : {Vec3{-0.5, 5, 5},
                            {9.5, 5, 5},
                            {5, -0.5, 5},
                            {5, 9.5, 5},
                            {5, 5, -0.5},
                            {5, 5, 9.5},
                            {5, 5, 4.5},
                            {1e300, 5, 5},
                            {-1e300, 5, 5}}) {
    EXPECT_TRUE(samples_in({corner, corner}, grid).empty());
    EXPECT_EQ(samples_in({corner, corner}, grid).count(), 0);
  }
  EXPECT_EQ(samples_in({inside, inside}, grid).count(), 1);
  EXPECT_TRUE(samples_in(Box{}, grid).empty());
}

}  // namespace
}  // namespace standoff
