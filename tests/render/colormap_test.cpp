// SPDX-License-Identifier: Apache-2.0
#include "render/image.h"

#include <gtest/gtest.h>

namespace standoff {
namespace {

TEST(Colormap, ViridisHasItsKnownColors) {
  EXPECT_EQ(color_of(Colormap::viridis, 0), (Color{68, 1, 84}));
  EXPECT_EQ(color_of(Colormap::viridis, 1), (Color{253, 231, 37}));
  // matplotlib's entry 64 of 0 to 255, which lies between ours.
  const Color quarter = color_of(Colormap::viridis, 64 / 255.0);
  const Color known{59, 82, 139};
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(quarter[c], known[c], 2);
}

TEST(Colormap, ViridisGrowsLighterAllTheWay) {
  double before = 0;
  for (int n = 0; n <= 200; ++n) {
    const Color color = color_of(Colormap::viridis, n / 200.0);
    const double light = 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
    EXPECT_GT(light, before - 0.5);
    before = light;
  }
}

TEST(Colormap, ThesisIsRedGreenBlue) {
  EXPECT_EQ(color_of(Colormap::thesis, 0), (Color{255, 0, 0}));
  EXPECT_EQ(color_of(Colormap::thesis, 0.5), (Color{0, 255, 0}));
  EXPECT_EQ(color_of(Colormap::thesis, 1), (Color{0, 0, 255}));
  EXPECT_EQ(color_of(Colormap::thesis, 0.125), (Color{255, 128, 0}));
}

TEST(Colormap, ValuesOutsideCountAsTheNearerEnd) {
  for (const Colormap map : {Colormap::viridis, Colormap::thesis}) {
    EXPECT_EQ(color_of(map, -3), color_of(map, 0));
    EXPECT_EQ(color_of(map, 1e300), color_of(map, 1));
  }
}

}  // namespace
}  // namespace standoff
