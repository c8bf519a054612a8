// SPDX-License-Identifier: Apache-2.0
// Which samples triangles cover: each sample of a surface once, whatever its triangles.
#include "render/screen_triangle.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace standoff {
namespace {

ScreenPoint at(double x, double y, float depth = 1) {
  return {static_cast<std::int32_t>(x * kSubpixels), static_cast<std::int32_t>(y * kSubpixels), depth};
}

// How often each sample of a picture of size x size pixels is covered.
class Counts {
 public:
  Counts(int size, int samples) : size_(size), places_(sample_places(samples)), counts_(size * size * samples, 0) {}

  void draw(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c) {
    const std::int64_t area = twice_area(a, b, c);
    if (area == 0) return;
    for_covered_pixels(a, b, c, area, pixels_of(a, b, c, box_of(places_)).within({0, 0, size_ - 1, size_ - 1}), places_,
                       [&](int x, int y, std::uint32_t mask) {
                         for (std::size_t s = 0; s < places_.size(); ++s)
                           counts_[(y * size_ + x) * places_.size() + s] += mask >> s & 1;
                       });
  }
  int at(int x, int y, int sample = 0) const { return counts_[(y * size_ + x) * places_.size() + sample]; }
  const std::vector<int>& all() const { return counts_; }

 private:
  int size_;
  std::span<const SamplePlace> places_;
  std::vector<int> counts_;
};

TEST(ScreenTriangle, CoversPixelsWhoseCentresLieInside) {
  Counts counts(6, 1);
  counts.draw(at(1, 1), at(5, 1), at(1, 3));
  const std::vector<std::string> expected{"......", ".###..", ".#....", "......", "......", "......"};
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 6; ++x)
      // Of the centres on the slope from (5,1) to (1,3), (4.5, 1.25) and so on, none lies on a pixel's.
      EXPECT_EQ(counts.at(x, y), expected[y][x] == '#') << x << "," << y;
}

// A square cut into triangles along random lines, with corners on samples too: every sample is covered once, also those
// on edges and corners.
TEST(ScreenTriangle, TrianglesOfASurfaceCoverEachSampleOnce) {
  std::mt19937 random(1);
  for (const int samples : {1, 2, 4, 8, 16})
    for (int round = 0; round < 8; ++round) {
      constexpr int kSize = 24, kGrid = 5;
      std::vector<ScreenPoint> corners;
      for (int j = 0; j <= kGrid; ++j)
        for (int i = 0; i <= kGrid; ++i) {
          // The rim lies outside the picture; the rest moves by less than half its distance. Steps of half a pixel put
          // many corners and edges on samples.
          const bool rim = i == 0 || j == 0 || i == kGrid || j == kGrid;
          const auto moved = [&](int n) {
            const int unit = round % 2 == 0 ? kSubpixels / 2 : 1;
            const int jitter = rim ? 0 : static_cast<int>(random() % 800) - 400;
            return ((n * (kSize + 8) / kGrid - 4) * kSubpixels + jitter) / unit * unit;
          };
          corners.push_back({moved(i), moved(j), 1});
        }
      Counts counts(kSize, samples);
      for (int j = 0; j < kGrid; ++j)
        for (int i = 0; i < kGrid; ++i) {
          const auto corner = [&](int di, int dj) { return corners[(j + dj) * (kGrid + 1) + i + di]; };
          // Either diagonal, and either orientation.
          if (random() % 2) {
            counts.draw(corner(0, 0), corner(1, 0), corner(1, 1));
            counts.draw(corner(0, 0), corner(0, 1), corner(1, 1));
          } else {
            counts.draw(corner(1, 0), corner(0, 0), corner(0, 1));
            counts.draw(corner(1, 1), corner(1, 0), corner(0, 1));
          }
        }
      for (std::size_t n = 0; n < counts.all().size(); ++n)
        ASSERT_EQ(counts.all()[n], 1) << samples << " samples, round " << round << ", sample " << n;
    }
}

TEST(ScreenTriangle, NarrowAndWideIntegersAgree) {
  std::mt19937 random(2);
  const auto number = [&] { return static_cast<std::int32_t>(random() % 8000); };
  for (int n = 0; n < 200; ++n) {
    const ScreenPoint a{number(), number(), 1}, b{number(), number(), 1}, c{number(), number(), 1};
    if (twice_area(a, b, c) <= 0) continue;
    const auto places = sample_places(16).first<16>();
    const PixelRange range = pixels_of(a, b, c, box_of(places));
    std::vector<std::uint32_t> narrow, wide;
    for_covered<std::int32_t>(a, b, c, range, places, [&](int x, int y, std::uint32_t m) {
      narrow.insert(narrow.end(), {static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), m});
    });
    for_covered<std::int64_t>(a, b, c, range, places, [&](int x, int y, std::uint32_t m) {
      wide.insert(wide.end(), {static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), m});
    });
    ASSERT_EQ(narrow, wide);
  }
}

TEST(ScreenTriangle, HugeTrianglesAreCut) {
  constexpr auto kFar = static_cast<std::int32_t>(kMostSubpixels) - 1;
  Counts counts(10, 4);
  counts.draw({-kFar, -kFar, 1}, {kFar, -kFar, 1}, {0, kFar, 1});
  for (const int count : counts.all()) EXPECT_EQ(count, 1);
}

TEST(ScreenTriangle, DepthIsLinearAndStaysBetweenTheCorners) {
  const ScreenPoint a = at(0, 0, 0.5F), b = at(100, 0, 0.7F), c = at(0, 100, 0.5F);
  const DepthPlane plane(a, b, c, twice_area(a, b, c));
  EXPECT_FLOAT_EQ(plane.at(50 * kSubpixels, 10 * kSubpixels), 0.6F);
  EXPECT_EQ(plane.at(1000 * kSubpixels, 0), 0.7F);
  EXPECT_EQ(plane.at(-1000 * kSubpixels, 0), 0.5F);
  const ScreenPoint sliver{25500, 1, 0.3F};
  const DepthPlane steep(a, b, sliver, twice_area(a, b, sliver));
  EXPECT_GE(steep.at(kSubpixels, 0), 0.3F);
  EXPECT_LE(steep.at(kSubpixels, 0), 0.7F);
}

}  // namespace
}  // namespace standoff
