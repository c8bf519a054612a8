// SPDX-License-Identifier: Apache-2.0
// Scenes that place a part again and again in one place: copies change no distance and cost nothing, but count for
// winding numbers. labels: memory threads
#include "field/skip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "standoff/error.h"
#include "standoff/occupancy.h"
#include "standoff/points.h"
#include "standoff/verify.h"
#include "tests/sign/shapes.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using namespace testing;
using Kept = std::vector<std::uint32_t>;

const Grid kCopiesGrid{{20, 19, 18}, {-2, -2, -2}, {0.21, 0.22, 0.23}};

// All parts once, then all again.
Mesh repeated(const Mesh& mesh, std::size_t times) {
  Mesh all = mesh;
  for (std::size_t n = 1; n < times; ++n)
    all.triangles.insert(all.triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
  return all;
}

Kept without_copies(const Mesh& mesh, std::span<const std::uint32_t> among = {}) {
  ProgressMeter nobody;
  return without_many_copies(mesh, among, nobody);
}

TEST(Copies, ManyAreNoticed) {
  for (const std::size_t times : {2, 3, 10, 1000})
    for (const int triangles : {1, 7, 300, 5000}) {
      if (times * static_cast<std::size_t>(triangles) > 1'000'000) continue;
      const Mesh mesh = random_soup(1, triangles, 1, 0.2);
      EXPECT_TRUE(has_many_copies(repeated(mesh, times))) << times << " times " << triangles;
      EXPECT_FALSE(has_many_copies(mesh)) << triangles;
    }
  // One of them alone, in a large mesh.
  Mesh mesh = random_soup(2, 20000, 1, 0.1);
  mesh.triangles.insert(mesh.triangles.begin() + 777, 2000, mesh.triangles[5000]);
  EXPECT_TRUE(has_many_copies(mesh));
  EXPECT_EQ(without_copies(mesh).size(), 20000u);
  // A triangle that is reversed, or moved to -0, is no copy.
  Mesh two_sided = random_soup(3, 2000, 1, 0.1);
  for (std::size_t n = 0; n < 2000; ++n) {
    const Triangle t = two_sided.triangles[n];
    two_sided.triangles.push_back({t[1], t[0], t[2]});
    two_sided.triangles.push_back({t[1], t[2], t[0]});
  }
  EXPECT_FALSE(has_many_copies(two_sided));
}

TEST(Copies, TheFirstOfEachStays) {
  Random random(4);
  Mesh mesh = random_soup(4, 3000, 1, 0.2);
  for (int n = 0; n < 9000; ++n) mesh.triangles.push_back(mesh.triangles[random.below(3000)]);
  for (std::size_t n = mesh.triangles.size(); n > 1; --n)
    std::swap(mesh.triangles[n - 1], mesh.triangles[random.below(static_cast<std::uint32_t>(n))]);
  EXPECT_EQ(without_copies(mesh), kept_by_exact_rule(mesh, kCopiesGrid, kInfinity));
  Kept among;
  for (std::uint32_t t = 5; t < mesh.triangles.size(); t += 1 + t % 2) among.push_back(t);
  Mesh part{mesh.vertices, {}};
  for (const std::uint32_t t : among) part.triangles.push_back(mesh.triangles[t]);
  Kept expected;
  for (const std::uint32_t n : kept_by_exact_rule(part, kCopiesGrid, kInfinity)) expected.push_back(among[n]);
  EXPECT_EQ(without_copies(mesh, among), expected);
}

// Fields without the copies, and with all of them.
TEST(Copies, ChangeNoBitOfAField) {
  const Mesh one = random_soup(5, 60, 1.5, 0.8), mesh = repeated(one, 20);
  for (const double thickness : {0.3, 1.0, kInfinity})
    for (const bool dense : {false, true}) {
      ComputeOptions options{.sign = {SignMethod::none}, .nearest = true};
      const auto values = [&](SkipRule::Kind kind, const Mesh& of, ComputeReport& report) {
        options.skip.kind = kind;
        const auto samples = static_cast<std::size_t>(kCopiesGrid.sample_count());
        std::vector<float> found(samples);
        std::vector<std::uint32_t> nearest(samples);
        if (dense) {
          report = compute_into(of, kCopiesGrid, thickness, found, nearest, options);
        } else {
          const ComputeResult computed = compute(of, kCopiesGrid, thickness, options);
          report = computed.report;
          for_each_sample(kCopiesGrid, [&](auto i, auto j, auto k) {
            const auto n = static_cast<std::size_t>(kCopiesGrid.index(i, j, k));
            found[n] = computed.field.value(i, j, k);
            nearest[n] = computed.field.nearest(i, j, k);
          });
        }
        return std::pair(found, nearest);
      };
      ComputeReport dropped, kept, of_one;
      const auto automatic = values(SkipRule::Kind::automatic, mesh, dropped);
      EXPECT_EQ(automatic, values(SkipRule::Kind::none, mesh, kept));
      EXPECT_EQ(automatic, values(SkipRule::Kind::automatic, one, of_one));
      EXPECT_EQ(dropped.skipped, 19 * 60);
      EXPECT_EQ(kept.skipped, 0);
      // All copies together cost as much as one. In bands of some spacings, all of them may take another algorithm.
      EXPECT_EQ(dropped.samples_examined, of_one.samples_examined);
      if (thickness != 1) EXPECT_GT(kept.samples_examined, 10 * of_one.samples_examined);
    }
}

TEST(Copies, ChangeNoAnswerAtPoints) {
  const Mesh one = sphere(), mesh = repeated(one, 30);
  Random random(6);
  std::vector<Vec3> points;
  for (int n = 0; n < 2000; ++n) points.push_back(random.in_cube(1.5));
  const auto ask = [&](const Mesh& of, SignMethod method) {
    const MeshQuery query(of, {{.method = method}, {}, {}});
    std::vector<ClosestPoint> found(points.size());
    query.closest(points, found);
    return found;
  };
  for (const SignMethod method : {SignMethod::none, SignMethod::winding}) {
    const auto some = ask(one, method), all = ask(mesh, method);
    for (std::size_t n = 0; n < points.size(); ++n) {
      ASSERT_EQ(all[n].distance, some[n].distance);
      ASSERT_EQ(all[n].triangle, some[n].triangle);
      ASSERT_EQ(all[n].point, some[n].point);
    }
  }
}

// A solid that is there twice has the winding number 2, which is outside by parity.
TEST(Copies, CountForTheSign) {
  const Mesh one = sphere(), mesh = repeated(one, 4);
  const MeshQuery query(mesh, {{.method = SignMethod::winding, .as_oriented = true}, {}, {}});
  const std::vector<Vec3> points = {{0, 0, 0}, {0.2, 0.3, 0.1}, {2, 0, 0}};
  std::vector<double> windings(3);
  query.winding_numbers(points, windings);
  EXPECT_EQ(windings, (std::vector<double>{4, 4, 0}));
  const auto inside = [&](const Mesh& of, WindingRule rule) {
    return occupancy(of, kCopiesGrid, {.sign = {.method = SignMethod::winding, .rule = rule, .as_oriented = true}})
        .count();
  };
  EXPECT_GT(inside(one, WindingRule::odd), 0);
  EXPECT_EQ(inside(mesh, WindingRule::odd), 0);
  EXPECT_EQ(inside(mesh, WindingRule::positive), inside(one, WindingRule::odd));
}

TEST(Copies, VerifyTakesThemAsOne) {
  const Mesh mesh = repeated(random_soup(7, 40, 1.5, 0.8), 25);
  const VerifyResult found = verify(computed(mesh, kCopiesGrid, 0.5).field, mesh);
  EXPECT_TRUE(found.ok());
  EXPECT_GT(found.samples_band, 0);
}

TEST(Copies, TheSearchForThemCanBeStopped) {
  const Mesh mesh = repeated(random_soup(8, 1000, 1, 0.2), 200);
  ProgressCallback stop = [](const Progress&) { return false; };
  ProgressMeter progress(stop);
  EXPECT_THROW(without_many_copies(mesh, {}, progress), Error);
}

}  // namespace
}  // namespace standoff
