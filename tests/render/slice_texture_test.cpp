// SPDX-License-Identifier: Apache-2.0
// Values of a plane between its samples, against the plane and closed forms.
#include "render/slice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scenes/scenes.h"
#include "standoff/compute.h"

namespace standoff {
namespace {

constexpr double kThickness = 0.3;

// The distances from the unit ball, in a band.
DistanceField ball() {
  ComputeOptions options{.sign = {.method = SignMethod::winding}};
  return compute(scenes::make("sphere", 20000), Grid{{41, 41, 41}, {-1.5, -1.5, -1.5}, {0.075, 0.075, 0.075}},
                 kThickness, options)
      .field;
}

SliceOptions middle() {
  SliceOptions options;
  options.axis = Axis::z;
  options.at = 0.5;
  return options;
}

TEST(SliceTexture, HasTheSamplesAndTheirMeanBetweenThem) {
  const SliceTexture slice(ball(), middle());
  const Plane& plane = slice.plane();
  for (std::int64_t u = 0; u + 1 < plane.height; u += 3)
    for (std::int64_t r = 0; r + 1 < plane.width; r += 3) {
      const auto x = static_cast<float>(r), y = static_cast<float>(u);
      EXPECT_EQ(slice.at(x, y).value, plane.value(r, u));
      EXPECT_NEAR(slice.at(x + 0.5F, y).value, (plane.value(r, u) + plane.value(r + 1, u)) / 2, 1e-7);
      EXPECT_NEAR(slice.at(x, y + 0.5F).value, (plane.value(r, u) + plane.value(r, u + 1)) / 2, 1e-7);
    }
  EXPECT_EQ(slice.at(-5, 100).value, plane.value(0, plane.height - 1));
}

// Between clamped samples the values would follow the squares of the samples: off by up to a spacing.
TEST(SliceTexture, TheBandEndsWhereTheDistanceIsTheThickness) {
  const DistanceField field = ball();
  const SliceTexture slice(field, middle());
  const double spacing = field.grid().spacing.x, centre = 20;
  double surface = 0;  // the ball's radius, of triangles
  for (float r = 20; slice.at(r, 20).value < 0; r += 0.01F) surface = (r - centre) * spacing;
  for (int degrees = 0; degrees < 360; degrees += 3) {
    const double x = std::cos(degrees * M_PI / 180), y = std::sin(degrees * M_PI / 180);
    double end = 0;
    for (double way = surface; way < surface + 2 * kThickness; way += 0.001) {
      const auto at =
          slice.at(static_cast<float>(centre + way * x / spacing), static_cast<float>(centre + way * y / spacing));
      if (at.edge >= slice.thickness()) break;
      end = way;
    }
    EXPECT_NEAR(end, surface + kThickness, 0.35 * spacing) << degrees;
  }
}

}  // namespace
}  // namespace standoff
