// SPDX-License-Identifier: Apache-2.0
// Public functions that are called again and again, on the default number of threads: memory does not grow, and small
// calls take none at all.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "scenes/scenes.h"
#include "standoff/collision.h"
#include "standoff/compute.h"
#include "standoff/points.h"
#include "tests/support/heap.h"

namespace standoff {
namespace {

namespace heap = testing::heap;

std::int64_t memory_in_use() {
  std::int64_t all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * ::getpagesize();
}

// A thread of TBB takes memory once, with its first work: on a busy machine, in any of the calls. A leak grows in every
// round.
void expect_no_growth(const std::string& name, const std::function<void()>& call) {
  constexpr int kRounds = 6, kCalls = 200;
  std::int64_t least_held = std::numeric_limits<std::int64_t>::max(), least_resident = least_held;
  for (int round = 0; round < kRounds && (least_held > 0 || least_resident >= 1'000'000); ++round) {
    const std::int64_t held = heap::held, resident = memory_in_use();
    for (int n = 0; n < kCalls; ++n) call();
    least_held = std::min(least_held, heap::held - held);
    least_resident = std::min(least_resident, memory_in_use() - resident);
  }
  EXPECT_LE(least_held, 0) << name;
  EXPECT_LT(least_resident, 1'000'000) << name;
}

Grid grid_of(std::int64_t side) { return {{side, side, side}, {-1.5, -1.5, -1.5}, {3.0 / 8, 3.0 / 8, 3.0 / 8}}; }

// Of an open mesh, whose winding numbers threads share.
TEST(ManyCalls, TakeNoMoreMemory) {
  const Mesh mesh = scenes::make("soup", 50);
  const MeshQuery query(mesh, {.sign = {.method = SignMethod::winding}});
  const Body body(scenes::make("box"));
  const std::vector<Vec3> points(3000, Vec3{0.1, 0.2, 0.3});
  std::vector<double> numbers(points.size());
  const std::vector<Pose> poses(40);
  expect_no_growth("compute",
                   [&] { static_cast<void>(compute(mesh, grid_of(9), kFullField, {.sign = {SignMethod::none}})); });
  expect_no_growth("compute a band",
                   [&] { static_cast<void>(compute(mesh, grid_of(9), 0.5, {.sign = {SignMethod::none}})); });
  expect_no_growth("make a query", [&] { MeshQuery made(mesh, {.sign = {SignMethod::none}}); });
  expect_no_growth("distances", [&] { query.distances(points, numbers); });
  expect_no_growth("winding numbers",
                   [&] { query.winding_numbers(std::span(points).first(10), std::span(numbers).first(10)); });
  expect_no_growth("collide", [&] { static_cast<void>(collide_all(body, {}, body, poses).results); });
  expect_no_growth("distance", [&] { static_cast<void>(distance_all(body, {}, body, poses).results); });
}

// After the first one. Any allocation is refused.
void expect_no_allocation(const std::string& name, const std::function<void()>& call) {
  call();
  const heap::Refusal refusal(0);
  try {
    for (int n = 0; n < 3; ++n) call();
  } catch (const std::exception& error) {
    ADD_FAILURE() << name << ": " << error.what();
  }
  EXPECT_FALSE(heap::Refusal::happened()) << name;
}

TEST(SmallCalls, OfPointsTakeNoMemory) {
  const MeshQueryOptions by_winding{.sign = {.method = SignMethod::winding, .as_oriented = true}};
  for (const char* const name : {"box", "sphere", "open", "soup", "duplicate", "one_triangle"})
    for (const bool is_signed : {false, true}) {
      const Mesh mesh = scenes::make(name, name[0] == 'b' ? 0 : 300);
      const MeshQuery query(mesh, is_signed ? by_winding : MeshQueryOptions{});
      std::vector<Vec3> points;
      for (int n = 0; n < 1000; ++n) points.push_back({0.003 * (n % 10), 0.01 * (n / 10 % 10) - 0.5, 0.02 * (n / 100)});
      points[3] = {1e9, 0, 0};  // beyond what boxes are rounded for
      std::vector<double> numbers(points.size());
      std::vector<ClosestPoint> closest(points.size());
      for (const std::size_t count :
           {std::size_t{1}, std::size_t{8}, std::size_t{32}, std::size_t{33}, std::size_t{100}, std::size_t{1000}}) {
        const std::string what =
            std::string(name) + (is_signed ? ", signed, " : ", ") + std::to_string(count) + " points";
        const std::span<const Vec3> some = std::span(points).first(count);
        expect_no_allocation("distances: " + what, [&] { query.distances(some, std::span(numbers).first(count)); });
        expect_no_allocation("closest: " + what, [&] { query.closest(some, std::span(closest).first(count)); });
      }
      if (is_signed && std::string(name) != "sphere")
        expect_no_allocation("winding number: " + std::string(name),
                             [&] { query.winding_numbers(std::span(points).first(1), std::span(numbers).first(1)); });
    }
}

TEST(SmallCalls, OfBodiesTakeNoMemory) {
  const Body a(scenes::make("bender")), b(scenes::make("fly"));
  const Pose apart = {.translation = {9, 0, 0}}, at = {.translation = {0.5, 0.5, 0}};
  for (const Pose& pose : {Pose{}, apart, at}) {
    expect_no_allocation("collide", [&] { static_cast<void>(collide(a, {}, b, pose)); });
    expect_no_allocation("certified",
                         [&] { static_cast<void>(collide(a, {}, b, pose, {.mode = CollideMode::certified})); });
    expect_no_allocation("distance", [&] { static_cast<void>(distance(a, {}, b, pose)); });
  }
}

}  // namespace
}  // namespace standoff
