// SPDX-License-Identifier: Apache-2.0
// Whatever takes long while sides are decided asks now and then whether it is to go on: also within one row of tiles,
// of which one thread may have many. The questions are counted, and none comes after the answer no.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "standoff/compute.h"
#include "standoff/confidence.h"
#include "standoff/error.h"
#include "standoff/occupancy.h"
#include "standoff/points.h"
#include "tests/sign/shapes.h"

namespace standoff {
namespace {

using namespace testing;

const Execution kOneThread{.threads = 1};
const SignOptions kWinding{.method = SignMethod::winding, .as_oriented = true};
const Grid kOneRowOfTiles{{64, 8, 8}, {-1, -0.1, -0.1}, {0.03, 0.03, 0.03}};

using Work = std::function<void(const ProgressCallback&)>;

// How often the work asks in stages of this name; in all stages if it has none.
int questions(const Work& work, const std::string& stage = "") {
  int count = 0;
  work([&](const Progress& now) {
    count += stage.empty() || now.stage == stage;
    return true;
  });
  return count;
}

// Says no at the n-th question, and expects no other one.
void expect_stop_at(int n, const Work& work) {
  int count = 0;
  try {
    work([&](const Progress&) { return ++count < n; });
    FAIL() << "it was not stopped at question " << n;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::interrupted);
  }
  EXPECT_EQ(count, n);
}

void expect_many_questions(const Work& work, int least, const std::string& stage = "") {
  const int asked = questions(work, stage), all = questions(work);
  EXPECT_GE(asked, least);
  for (const int n : {all / 7 + 1, all / 2, all - 2}) expect_stop_at(n, work);
}

// 4096 samples, each beside thousands of rims: some million solid angles.
TEST(Stop, WithinARowOfTilesOfASoup) {
  const Mesh mesh = random_soup(1, 3000, 1, 0.4);
  expect_many_questions(
      [&](const ProgressCallback& progress) {
        occupancy(mesh, kOneRowOfTiles, {.sign = kWinding, .execution = kOneThread, .progress = progress});
      },
      60);
  expect_many_questions(
      [&](const ProgressCallback& progress) {
        compute(mesh, kOneRowOfTiles, 0.05, {.sign = kWinding, .execution = kOneThread, .progress = progress});
      },
      60, "sign");
}

TEST(Stop, WithinTheMarginsOfARow) {
  const Mesh mesh = random_soup(1, 3000, 1, 0.4);
  const Grid row{{256, 1, 1}, {-1, 0, 0}, {0.008, 1, 1}};
  expect_many_questions(
      [&](const ProgressCallback& progress) {
        winding_margins(mesh, row, {.sign = kWinding, .execution = kOneThread, .progress = progress});
      },
      10);
}

TEST(Stop, AmongPointsBesideASoup) {
  const Mesh mesh = random_soup(1, 3000, 1, 0.4);
  const MeshQuery query(mesh, {kWinding, kOneThread, {}});
  Random random(2);
  std::vector<Vec3> points;
  for (int n = 0; n < 300; ++n) points.push_back(random.in_cube(1));  // that are decided together
  std::vector<double> found(points.size());
  expect_many_questions(
      [&](const ProgressCallback& progress) {
        query.distances(points, found, {.execution = kOneThread, .progress = progress});
      },
      10);
  expect_many_questions(
      [&](const ProgressCallback& progress) {
        query.winding_numbers(points, found, {.execution = kOneThread, .progress = progress});
      },
      300);
}

// Few triangles, each of which very many rows and edges pass through.
TEST(Stop, WithinOneTriangle) {
  Mesh mesh;
  add_triangle(mesh, {-9, -9, -9}, {9, 8, -9}, {0, 0, 12});
  add_triangle(mesh, {-9, -9, -9}, {0, 0, 12}, {9, 8, -9});
  const Grid grid{{4, 700, 700}, {-1, -1, -1}, {0.5, 0.003, 0.003}};
  for (const SignMethod method : {SignMethod::parity, SignMethod::flood})
    expect_many_questions(
        [&](const ProgressCallback& progress) {
          occupancy(mesh, grid, {.sign = {.method = method}, .execution = kOneThread, .progress = progress});
        },
        60);
}

// One thread has all rows of tiles in one range.
TEST(Stop, BetweenRowsOfTiles) {
  const Mesh mesh = sphere();
  const Grid grid{{8, 160, 160}, {-1, -1, -1}, {0.3, 0.0125, 0.0125}};
  expect_many_questions(
      [&](const ProgressCallback& progress) {
        occupancy(mesh, grid, {.sign = {.method = SignMethod::parity}, .execution = kOneThread, .progress = progress});
      },
      400);
  for (const SignMethod method : {SignMethod::normal, SignMethod::shell})
    expect_many_questions(
        [&](const ProgressCallback& progress) {
          ComputeOptions options{.sign = {.method = method, .shell = method == SignMethod::shell ? 0.1 : 0},
                                 .execution = kOneThread,
                                 .progress = progress};
          compute(mesh, grid, 0.5, options);
        },
        400, "sign");
}

}  // namespace
}  // namespace standoff
