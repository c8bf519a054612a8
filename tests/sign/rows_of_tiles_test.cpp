// SPDX-License-Identifier: Apache-2.0
// Rows of tiles come once each, by as many layers as are asked for, whatever their sides load at a time.
#include <gtest/gtest.h>

#include <atomic>
#include <vector>

#include "sign/each_row_of_tiles.h"

namespace standoff {
namespace {

// Loads so many rows of tiles at a time, and marks one sample in each row.
class FewAtATime final : public Sides {
 public:
  FewAtATime(std::int64_t rows, std::int64_t tiles_y) : rows_(rows), tiles_y_(tiles_y) {}
  std::int64_t load(std::int64_t first) override {
    EXPECT_EQ(first, end_);
    begin_ = first;
    return end_ = first + rows_;
  }
  void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const override {
    const std::int64_t n = ty + tiles_y_ * tz;
    EXPECT_GE(n, begin_);
    EXPECT_LT(n, end_);
    rows.set(0, n, n + 1);
  }

 private:
  std::int64_t rows_, tiles_y_, begin_ = 0, end_ = 0;
};

TEST(RowsOfTiles, EachComesOnce) {
  const Grid grid{{70, 33, 60}, {}, {1, 1, 1}};
  constexpr std::int64_t kTilesY = 5, kLayers = 8;
  for (const std::int64_t loaded : {1, 3, 5, 7, 12, 100})
    for (const std::int64_t layers : {1, 2, 3, 8, 20}) {
      FewAtATime sides(loaded, kTilesY);
      ProgressMeter progress;
      RowsOfTiles rows(sides, false, grid, progress);
      std::vector<std::atomic<int>> seen(kTilesY * kLayers);
      for (std::int64_t first = 0; first < kLayers; first += layers)
        rows.next_layers(layers, [&](const InsideRows& inside, std::int64_t ty, std::int64_t tz) {
          EXPECT_GE(tz, first);
          EXPECT_LT(tz, first + layers);
          const std::int64_t n = ty + kTilesY * tz;
          EXPECT_TRUE(inside.is_inside(0, n));
          ++seen[static_cast<std::size_t>(n)];
        });
      for (const auto& times : seen) EXPECT_EQ(times, 1) << loaded << " rows at a time, " << layers << " layers";
    }
}

}  // namespace
}  // namespace standoff
