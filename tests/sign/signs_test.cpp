// SPDX-License-Identifier: Apache-2.0
// Which samples are inside, against integers: all coordinates are integers, so which side of a plane a sample is on is
// known exactly. Samples lie on corners, edges and planes of triangles, and next to them by less than double resolves
// in a determinant.
#include "sign/signs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "sign/rows/row_crossings.h"
#include "tests/sign/solid_soup.h"

namespace standoff {
namespace {

using testing::Random;
using testing::Tetrahedron;

struct Outcome {
  std::int64_t inside = 0, outside = 0, on_surface = 0, wrong = 0;
};

// Compares each sample of the grid with what is known of it.
template <class IsInside>
Outcome compare(const std::vector<Tetrahedron>& tetrahedra, const Grid& grid, const SignOptions& options,
                const IsInside& is_inside) {
  const Mesh mesh = testing::mesh_of(tetrahedra);
  const ProgressCallback none;
  ProgressMeter progress(none);
  const WindingRule rule = options.method == SignMethod::parity ? WindingRule::odd : options.rule;
  IntegerWinding winding({mesh}, grid, rule, progress);
  EXPECT_EQ(winding.load(0), (grid.size.y + 7) / 8 * ((grid.size.z + 7) / 8));
  InsideRows rows(grid);
  Outcome outcome;
  for (std::int64_t tz = 0; 8 * tz < grid.size.z; ++tz)
    for (std::int64_t ty = 0; 8 * ty < grid.size.y; ++ty) {
      rows.clear(ty, tz);
      winding.fill(rows, ty, tz);
      if (options.invert) rows.invert();
      for (int row = 0; row < 64; ++row)
        for (std::int64_t i = 0; i < 8 * ((grid.size.x + 7) / 8); ++i) {
          const std::int64_t j = 8 * ty + row % 8, k = 8 * tz + row / 8;
          const bool inside = rows.is_inside(row, i);
          if (i >= grid.size.x || j >= grid.size.y || k >= grid.size.z) {
            outcome.wrong += inside;  // beyond the grid all is outside
            continue;
          }
          const auto known = testing::known_winding(tetrahedra, grid.position(i, j, k));
          ++(known.on_surface ? outcome.on_surface : inside ? outcome.inside : outcome.outside);
          outcome.wrong += !known.on_surface && inside != is_inside(known.winding);
        }
    }
  return outcome;
}

bool positive(std::int32_t winding) { return winding > 0; }

TEST(InsideRows, SamplesOnCornersEdgesAndPlanes) {
  Outcome all;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Random random(seed);
    const auto tetrahedra = testing::integer_tetrahedra(random, 6, 5);
    const Outcome one = compare(tetrahedra, {{13, 13, 13}, {-6, -6, -6}}, {.method = SignMethod::winding}, positive);
    EXPECT_EQ(one.wrong, 0) << "seed " << seed;
    all.inside += one.inside;
    all.outside += one.outside;
    all.on_surface += one.on_surface;
  }
  EXPECT_GT(all.inside, 500);
  EXPECT_GT(all.on_surface, 5000);
}

TEST(InsideRows, RulesInvertedAndParity) {
  for (unsigned seed = 100; seed < 130; ++seed) {
    Random random(seed);
    const auto tetrahedra = testing::integer_tetrahedra(random, 9, 7);
    const Grid grid{{19, 17, 16}, {-9, -8, -8}};
    const auto odd = [](std::int32_t winding) { return winding % 2 != 0; };
    const auto wrong = [&](const SignOptions& options, const auto& rule) {
      return compare(tetrahedra, grid, options, rule).wrong;
    };
    EXPECT_EQ(wrong({SignMethod::winding, WindingRule::nonzero}, [](std::int32_t w) { return w != 0; }), 0) << seed;
    EXPECT_EQ(wrong({SignMethod::winding, WindingRule::odd}, odd), 0) << seed;
    EXPECT_EQ(wrong({SignMethod::parity}, odd), 0) << seed;
    EXPECT_EQ(wrong({SignMethod::winding, WindingRule::positive, true}, [](std::int32_t w) { return w <= 0; }), 0);
  }
}

// Coordinates have 37 bits: a determinant in double is off by far more than the step from one sample to the next.
TEST(InsideRows, SamplesNextToAPlaneWithinRounding) {
  constexpr double kHalf = 0x1p36;
  Outcome all;
  for (unsigned seed = 0; seed < 400; ++seed) {
    Random random(seed);
    const auto coordinate = [&](double half) { return std::floor(random.between(-half, half)); };
    Tetrahedron t;
    for (Vec3& v : t) v = {coordinate(kHalf), coordinate(kHalf), coordinate(kHalf)};
    // A point near a face, and a row along x that passes through the face next to it.
    const double a = random.between(0.1, 0.5), b = random.between(0.1, 0.4);
    const Vec3 on_face = t[1] + (t[2] - t[1]) * a + (t[3] - t[1]) * b;
    const Vec3 origin{std::floor(on_face.x) - 16, std::floor(on_face.y), std::floor(on_face.z)};
    const Outcome one =
        compare({t}, {{33, 2, 2}, origin}, {.method = SignMethod::winding, .rule = WindingRule::nonzero},
                [](std::int32_t w) { return w != 0; });
    EXPECT_EQ(one.wrong, 0) << "seed " << seed;
    all.inside += one.inside;
    all.outside += one.outside;
  }
  EXPECT_GT(all.inside, 5000);
  EXPECT_GT(all.outside, 5000);
}

TEST(InsideRows, SheetsOfThousandsOfShells) {
  // Nested cubes, all oriented alike: the winding number counts them.
  std::vector<Tetrahedron> nested;
  for (int n = 1; n <= 3000; ++n) {
    const double s = n;
    nested.push_back({Vec3{-s, -s, -s}, Vec3{3 * s, -s, -s}, Vec3{-s, 3 * s, -s}, Vec3{-s, -s, 3 * s}});
  }
  const Grid grid{{40, 3, 3}, {-100.5, -1.5, -1.5}};
  const Mesh mesh = testing::mesh_of(nested);
  const ProgressCallback none;
  ProgressMeter progress(none);
  const RowCrossings crossings({mesh}, grid, progress);
  std::int32_t deepest = 0;
  for (int row = 0; row < 64; ++row) {
    std::int32_t winding = 0;
    for (const RowCrossing& one : crossings.of_tiles(0, 0))
      if (one.row() == row) deepest = std::max(deepest, std::abs(winding += one.step()));
  }
  EXPECT_EQ(deepest, 2939);  // at the last sample, x = -61.5: the shells from 62 on
}

// One solid many times: winding numbers of just a byte, of more, and those whose lowest byte is 0. Beside it, one.
std::vector<Tetrahedron> copies_beside_one(int copies) {
  const Tetrahedron solid{Vec3{-8, -8, -8}, Vec3{7, -8, -8}, Vec3{-8, 7, -8}, Vec3{-8, -8, 7}};
  std::vector<Tetrahedron> all(static_cast<std::size_t>(copies), solid);
  all.push_back({Vec3{2, 2, 2}, Vec3{9, 2, 2}, Vec3{2, 9, 2}, Vec3{2, 2, 9}});
  return all;
}

TEST(InsideRows, WindingNumbersOfMoreThanAByte) {
  const Grid grid{{19, 9, 8}, {-9, -8, -8}, {1, 2, 2}};
  const auto odd = [](std::int32_t w) { return w % 2 != 0; };
  for (const int copies : {1, 62, 63, 128, 256}) {
    const auto solids = copies_beside_one(copies);
    for (const auto& [rule, is_inside] :
         {std::pair<WindingRule, bool (*)(std::int32_t)>{WindingRule::positive, positive},
          {WindingRule::nonzero, [](std::int32_t w) { return w != 0; }},
          {WindingRule::odd, odd}}) {
      const Outcome one = compare(solids, grid, {.method = SignMethod::winding, .rule = rule}, is_inside);
      EXPECT_EQ(one.wrong, 0) << copies << " copies";
      EXPECT_GT(one.inside, 0) << copies << " copies";
    }
  }
}

TEST(InsideRows, AWindowIsAPartOfAll) {
  const Grid grid{{35, 17, 16}, {-9, -8, -8}, {0.6, 1, 1}};
  const Grid window = grid.window({16, 0, 0}, {16, 17, 16});
  ProgressMeter progress;
  for (const int copies : {1, 300}) {
    const Mesh mesh = testing::mesh_of(copies_beside_one(copies));
    IntegerWinding winding({mesh}, grid, WindingRule::positive, progress);
    winding.load(0);
    InsideRows all(grid), some(grid, window);
    int both = 0;
    for (std::int64_t n = 0; n < 3 * 2; ++n) {
      for (InsideRows* const rows : {&all, &some}) {
        rows->clear(n % 3, n / 3);
        winding.fill(*rows, n % 3, n / 3);
      }
      for (std::int64_t tx = 2; tx < 4; ++tx)
        for (std::size_t row = 0; row < 64; ++row) {
          EXPECT_EQ(std::as_const(some).tile(tx)[row], std::as_const(all).tile(tx)[row]);
          both += std::as_const(all).tile(tx)[row] != 0;
        }
    }
    EXPECT_GT(both, 5);
  }
}

}  // namespace
}  // namespace standoff
