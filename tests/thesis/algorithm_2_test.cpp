// SPDX-License-Identifier: Apache-2.0
// Algorithm 2 gives the answers of its definition, written out here once more, on the CPU and on the emulated GPU in
// every order of threads; and fields of meshes that move are those of compute(), on both.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "gpu/emulation/block.h"
#include "gpu/platform_emulated.h"
#include "standoff/compute.h"
#include "standoff/cuda.h"
#include "standoff/testing/emulation.h"
#include "standoff/thesis.h"
#include "tests/collision/bodies.h"
#include "tests/support/fields.h"

namespace standoff {
namespace {

using namespace standoff::testing;
using emulation::Order;
using emulation::OrderScope;

const Execution kOnCpu{.backend = Backend::cpu}, kOnEmulation{.backend = testing::kEmulated};

struct Answer {
  ThesisCollisionResult result;
  double sum;

  friend bool operator==(const Answer& a, const Answer& b) {
    return a.result.hit == b.result.hit && a.result.samples == b.result.samples &&
           std::bit_cast<std::uint64_t>(a.sum) == std::bit_cast<std::uint64_t>(b.sum);
  }
};

void PrintTo(const Answer& answer, std::ostream* out) {
  *out << (answer.result.hit ? "hit" : "free") << " after " << answer.result.samples << ", least sum " << answer.sum;
}

// The definition, sample by sample. Requires that the boxes of the grids overlap.
Answer by_definition(const DistanceField& a, const Pose& pose_a, const DistanceField& b, const Pose& pose_b,
                     double threshold) {
  if (a.grid().sample_count() < b.grid().sample_count()) return by_definition(b, pose_b, a, pose_a, threshold);
  Answer answer{{}, kInfinity};
  const Grid& grid = a.grid();
  for_each_sample(b.grid(), [&](auto i, auto j, auto k) {
    answer.result.samples += !answer.result.hit;
    const Vec3 p = apply_inverse(pose_a, apply(pose_b, b.grid().position(i, j, k)));
    const double u = std::floor((p.x - grid.origin.x) / grid.spacing.x + 0.5),
                 v = std::floor((p.y - grid.origin.y) / grid.spacing.y + 0.5),
                 w = std::floor((p.z - grid.origin.z) / grid.spacing.z + 0.5);
    const auto size = [](std::int64_t n) { return static_cast<double>(n); };
    if (!(u >= 0 && v >= 0 && w >= 0 && u < size(grid.size.x) && v < size(grid.size.y) && w < size(grid.size.z)))
      return;
    const float mine = b.value(i, j, k), theirs = a.value(std::int64_t(u), std::int64_t(v), std::int64_t(w));
    if (std::abs(mine) >= static_cast<float>(b.thickness()) || std::abs(theirs) >= static_cast<float>(a.thickness()))
      return;
    const double sum = double{mine} + double{theirs};
    answer.sum = std::min(answer.sum, sum == 0 ? 0.0 : sum);
    answer.result.hit |= sum < threshold;
  });
  return answer;
}

Answer on_host(const DistanceField& a, const Pose& pose_a, const DistanceField& b, const Pose& pose_b,
               double threshold) {
  return {collide_thesis(a, pose_a, b, pose_b, threshold), thesis_sum(a, pose_a, b, pose_b)};
}

Answer held(const ThesisField& a, const Pose& pose_a, const ThesisField& b, const Pose& pose_b, double threshold) {
  return {collide_thesis(a, pose_a, b, pose_b, threshold), thesis_sum(a, pose_a, b, pose_b)};
}

struct Tally {
  int hits = 0, free = 0, without_sum = 0;
};

// All ways to ask give the answer of the definition.
void expect_as_defined(const DistanceField& a, const DistanceField& b, unsigned seed, double half, Tally& tally,
                       int poses = 25) {
  const ThesisField host_a(a, kOnCpu), host_b(b, kOnCpu), device_a(a, kOnEmulation), device_b(b, kOnEmulation);
  Random random(seed);
  for (int n = 0; n < poses; ++n) {
    SCOPED_TRACE("pose " + std::to_string(n));
    const Pose pose_a = random_pose(random, 0.3), pose_b = random_pose(random, half);
    const double threshold = random.between(0.01, 0.6);
    const Answer found = on_host(a, pose_a, b, pose_b, threshold);
    if (found.result.samples > 0) {
      EXPECT_EQ(found, by_definition(a, pose_a, b, pose_b, threshold));
    }
    EXPECT_EQ(held(host_a, pose_a, host_b, pose_b, threshold), found);
    EXPECT_EQ(held(device_a, pose_a, device_b, pose_b, threshold), found);
    EXPECT_EQ(held(device_b, pose_b, device_a, pose_a, threshold), on_host(b, pose_b, a, pose_a, threshold));
    found.result.hit ? ++tally.hits : ++tally.free;
    tally.without_sum += std::isinf(found.sum);
  }
}

DistanceField field_of(const Mesh& mesh, double thickness, double e, SignMethod sign = SignMethod::none) {
  return compute(mesh, minimum_grid(bounds(mesh), thickness, e), thickness, {.sign = {sign}}).field;
}

TEST(Algorithm2, IsItsDefinitionOnEveryDevice) {
  const DistanceField soup = field_of(random_soup(1, 60, 1, 0.3), 0.5, 3),
                      ball = field_of(ball_mesh(0.7, 5), 0.3, 2, SignMethod::winding),
                      nasty = field_of(nasty_soup(2, 20, 1), 0.8, 2),
                      full = compute(ball_mesh(0.4, 3), {{9, 11, 7}, {-1, -1, -1}, {0.2, 0.17, 0.3}}, kFullField).field;
  for (const Order order : {Order::forward, Order::reverse, Order::random}) {
    SCOPED_TRACE("order " + std::to_string(static_cast<int>(order)));
    const OrderScope scope(order, 7);
    Tally tally;
    expect_as_defined(soup, ball, 3, 1.6, tally);
    expect_as_defined(ball, nasty, 4, 1.6, tally);
    expect_as_defined(nasty, full, 5, 2, tally);
    expect_as_defined(full, full, 6, 2.5, tally);
    EXPECT_GT(tally.hits, 15);
    EXPECT_GT(tally.free, 15);
    EXPECT_GT(tally.without_sum, 0);
  }
}

TEST(Algorithm2, GridsOfAnySize) {
  Random random(8);
  const auto noise = [&](Size3 size, double thickness) {
    std::vector<float> values(static_cast<std::size_t>(size.count()));
    for (float& value : values) value = static_cast<float>(random.between(-1.3, 1.3));
    const Vec3 spacing{1.0 / double(size.x), 1.5 / double(size.y), 2.0 / double(size.z)};
    return DistanceField::from_dense({size, {-0.5, -0.7, -1}, spacing}, thickness, values);
  };
  std::vector<DistanceField> fields;
  for (const Size3 size :
       {Size3{1, 1, 1}, Size3{1, 9, 1}, Size3{8, 8, 8}, Size3{9, 7, 8}, Size3{17, 1, 3}, Size3{4, 5, 19}})
    fields.push_back(noise(size, 1 + 0.1 * double(fields.size())));
  fields.push_back(DistanceField({{12, 3, 9}, {-1, -1, -1}, {0.2, 0.6, 0.2}}, 0.5));  // without a value
  fields.push_back(DistanceField());                                                  // not even a tile of them
  Tally tally;
  for (std::size_t a = 0; a < fields.size(); ++a)
    for (std::size_t b = 0; b < fields.size(); ++b) {
      SCOPED_TRACE(std::to_string(a) + " and " + std::to_string(b));
      expect_as_defined(fields[a], fields[b], static_cast<unsigned>(9 + 7 * a + b), 0.5, tally, 6);
    }
  EXPECT_GT(tally.hits, 50);
  EXPECT_GT(tally.without_sum, 50);
}

// Sample (0,0,0) on (0,0,0).
DistanceField one_value(float value, double thickness = 1) {
  return DistanceField::from_dense({{1, 1, 1}, {}, {1, 1, 1}}, thickness, std::vector{value});
}

TEST(Algorithm2, TheThresholdItselfIsFree) {
  for (const Execution& execution : {kOnCpu, kOnEmulation}) {
    const ThesisField a(one_value(0.25f), execution), b(one_value(0.5f), execution);
    EXPECT_FALSE(collide_thesis(a, {}, b, {}, 0.75).hit);
    EXPECT_TRUE(collide_thesis(a, {}, b, {}, std::nextafter(0.75, 1.0)).hit);
    EXPECT_EQ(thesis_sum(a, {}, b, {}), 0.75);
    // A value of the thickness is none.
    const ThesisField none(one_value(0.5f, 0.5), execution);
    EXPECT_FALSE(collide_thesis(a, {}, none, {}, 100).hit);
    // Of several samples that decide, the first one is told.
    std::vector<float> row(40, 0.9f);
    row[23] = row[31] = 0.1f;
    const ThesisField line(DistanceField::from_dense({{40, 1, 1}, {}, {0.01, 1, 1}}, 1, row), execution);
    const ThesisField many(DistanceField::from_dense({{64, 1, 1}, {}, {0.01, 1, 1}}, 1, std::vector(64, 0.0f)),
                           execution);
    EXPECT_EQ(collide_thesis(many, {}, line, {}, 0.5).samples, 24);
    EXPECT_EQ(collide_thesis(many, {}, line, {}, 0.05).samples, 40);
    EXPECT_EQ(collide_thesis(many, {}, line, moved({50, 0, 0}), 0.5).samples, 0);
    // No sum is -0, whichever comes first.
    const ThesisField zero(one_value(-0.0f), execution);
    EXPECT_FALSE(std::signbit(thesis_sum(zero, {}, zero, {})));
  }
}

// Reads a field by a field of one sample, whose value is 0.
class Reader {
 public:
  explicit Reader(const Execution& execution) : probe_(one_value(0), execution) {}
  // The value at the sample nearest to a point; infinite if there is none.
  double operator()(const ThesisField& field, Vec3 p) const { return thesis_sum(field, {}, probe_, moved(p)); }

 private:
  ThesisField probe_;
};

Mesh moved_mesh(Mesh mesh, const Pose& pose) {
  for (Vec3& v : mesh.vertices) v = apply(pose, v);
  return mesh;
}

TEST(MinimumField, IsThatOfTheMovedMeshOnEveryDevice) {
  constexpr double kThickness = 0.5;
  const Reader host_value(kOnCpu), device_value(kOnEmulation);
  Random random(10);
  for (const Mesh& mesh : {ball_mesh(0.7, 3), nasty_soup(11, 30, 1)})
    for (const Order order : {Order::forward, Order::reverse, Order::random}) {
      SCOPED_TRACE("order " + std::to_string(static_cast<int>(order)));
      const OrderScope scope(order, 5);
      const MinimumField host(mesh, kThickness, 2, 0.1, kOnCpu), device(mesh, kThickness, 2, 0.1, kOnEmulation);
      for (int n = 0; n < 3; ++n) {
        const Pose pose = random_pose(random, n == 2 ? 1e6 : 3);
        const Mesh there = moved_mesh(mesh, pose);
        const Grid grid = minimum_grid(bounds(there), kThickness, 2, 0.1);
        const DistanceField expected =
            compute(there, grid, kThickness,
                    {.method = Method::thesis, .skip = {SkipRule::Kind::none}, .sign = {SignMethod::none}})
                .field;
        const std::int64_t unwritten = emulated::unwritten_words_copied;
        const ThesisField on_cpu = host.at(pose), on_device = device.at(pose);
        EXPECT_EQ(on_cpu.grid(), grid);
        EXPECT_EQ(on_device.grid(), grid);
        EXPECT_EQ(on_device.thickness(), kThickness);
        int valued = 0;
        for_each_sample(grid, [&](auto i, auto j, auto k) {
          const float value = expected.value(i, j, k);
          const double sum = value < kThickness ? double{value} : kInfinity;
          valued += !std::isinf(sum);
          const Vec3 p = grid.position(i, j, k);
          ASSERT_EQ(host_value(on_cpu, p), sum);
          ASSERT_EQ(device_value(on_device, p), sum);
        });
        EXPECT_GT(valued, 20);
        EXPECT_EQ(emulated::unwritten_words_copied, unwritten);
      }
    }
}

TEST(MinimumField, FieldsInUseKeepTheirValuesAndMemoryIsUsedAgain) {
  for (const Execution& execution : {kOnCpu, kOnEmulation}) {
    const MinimumField field(ball_mesh(0.5, 2), 0.5, 2, 0, execution);
    const Reader value(execution);
    const Vec3 probe{0.5, 0, 0};
    const ThesisField first = field.at({}), other = field.at(moved({10, 0, 0})), copy = first;
    EXPECT_LT(value(first, probe), 0.5);
    EXPECT_LT(value(other, probe + Vec3{10, 0, 0}), 0.5);
    EXPECT_EQ(value(other, probe), kInfinity);
    std::int64_t taken = 0;
    for (int n = 0; n < 5; ++n) {
      {
        const ThesisField third = field.at(moved({0, 0, double(n)}));
        EXPECT_LT(value(third, probe + Vec3{0, 0, double(n)}), 0.5);
        if (n == 0) taken = emulated::memory_taken;
        EXPECT_EQ(emulated::memory_taken, taken);
      }
      EXPECT_EQ(emulated::memory_taken, taken) << "it waits for the next pose";
    }
    EXPECT_LT(value(copy, probe), 0.5);
  }
}

TEST(MinimumField, ServesSeveralThreads) {
  const MinimumField field(ball_mesh(0.5, 2), 0.5, 2, 0, {.threads = 1});
  const ThesisField wall(field_of(ball_mesh(0.6, 3), 0.5, 2));
  const auto sums = [&] {
    std::vector<double> all;
    for (int n = 0; n < 20; ++n) all.push_back(thesis_sum(wall, {}, field.at(moved({0.1 * n, 0, 0})), {}));
    return all;
  };
  const std::vector<double> expected = sums();
  std::vector<std::thread> threads;
  std::vector<std::vector<double>> found(4);
  for (auto& mine : found) threads.emplace_back([&] { mine = sums(); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& mine : found) EXPECT_EQ(mine, expected);
}

TEST(Algorithm2, Errors) {
  const DistanceField field = one_value(0.25f);
  const ThesisField host(field), device(field, kOnEmulation);
  EXPECT_EQ(host.backend(), Backend::cpu);
  EXPECT_EQ(host.device_name(), "");
  EXPECT_EQ(device.backend(), testing::kEmulated);
  EXPECT_EQ(device.device_name(), "emulated on the CPU");
  EXPECT_EQ(code_of([&] { collide_thesis(host, {}, device, {}, 1); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { thesis_sum(device, {}, host, {}); }), ErrorCode::usage);
  const Mesh mesh = ball_mesh(1, 2);
  for (const Execution& execution : {kOnCpu, kOnEmulation}) {
    const ThesisField one(field, execution);
    for (const double threshold : {0.0, -1.0, std::nan("")})
      EXPECT_EQ(code_of([&] { collide_thesis(one, {}, one, {}, threshold); }), ErrorCode::usage);
    Pose bad;
    bad.rotation[0] = 2;
    EXPECT_EQ(code_of([&] { thesis_sum(one, bad, one, {}); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { MinimumField(mesh, 1, 2, 0, execution).at(bad); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { MinimumField(mesh, 0, 2, 0, execution); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { MinimumField(mesh, 1, 0.5, 0, execution); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { MinimumField(Mesh{}, 1, 2, 0, execution); }), ErrorCode::input);
    EXPECT_EQ(code_of([&] { MinimumField(ball_mesh(1e30, 2), 1e30 * 1e-9, 2, 0, execution).at({}); }),
              ErrorCode::limit);
  }
  for (const Execution& refused : {Execution{.threads = -1}, Execution{.device = -1}}) {
    EXPECT_EQ(code_of([&] { ThesisField(field, refused); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { MinimumField(mesh, 1, 2, 0, refused); }), ErrorCode::usage);
  }
  if (cuda::devices().empty()) {
    EXPECT_EQ(code_of([&] { ThesisField(field, {.backend = Backend::cuda}); }), ErrorCode::device);
    EXPECT_EQ(code_of([&] { MinimumField(mesh, 1, 2, 0, {.backend = Backend::cuda}); }), ErrorCode::device);
  }
  const std::int64_t total = emulated::memory_total;
  emulated::memory_total = emulated::memory_taken + 1000;
  const auto too_small = code_of([&] { ThesisField(DistanceField({{64, 64, 64}, {}, {1, 1, 1}}, 2), kOnEmulation); });
  emulated::memory_total = total;
  EXPECT_EQ(too_small, ErrorCode::limit);
}

}  // namespace
}  // namespace standoff
