// SPDX-License-Identifier: Apache-2.0
// Values of samples that lie exactly on the surface, and their signs (docs/sign_methods.md, "Guarantees").
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "standoff/testing/emulation.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using namespace standoff::testing;

// A box whose faces lie on planes of samples, from one sample to another.
struct BoxOnGrid {
  Grid grid;
  std::array<std::int64_t, 3> low, high;

  Mesh mesh() const {
    Mesh mesh;
    for (unsigned n = 0; n < 8; ++n)
      mesh.vertices.push_back(
          grid.position(n & 1 ? high[0] : low[0], n & 2 ? high[1] : low[1], n & 4 ? high[2] : low[2]));
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
  }
  enum class Place { off, inside_of_a_face, on_an_edge };
  // The place of a sample: off the surface, inside a face's triangle, or on an edge or a diagonal.
  Place place(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const std::array<std::int64_t, 3> at{i, j, k};
    int across = -1, faces = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (at[axis] < low[axis] || at[axis] > high[axis]) return Place::off;
      if (at[axis] == low[axis] || at[axis] == high[axis]) across = axis, ++faces;
    }
    if (faces == 0) return Place::off;
    const int u = (across + 1) % 3, v = (across + 2) % 3;
    const std::int64_t a = (at[u] - low[u]) * (high[v] - low[v]), b = (at[v] - low[v]) * (high[u] - low[u]),
                       all = (high[u] - low[u]) * (high[v] - low[v]);
    // Every face is cut in two from its first corner to its last.
    return faces > 1 || a == b || a + b == all ? Place::on_an_edge : Place::inside_of_a_face;
  }
};

const BoxOnGrid kBoxes[] = {
    {{{24, 25, 26}, {-1, -1, -1}, {0.125, 0.125, 0.125}}, {8, 8, 8}, {16, 16, 16}},
    {{{24, 25, 26}, {-0.3, 1000.1, -7}, {0.1, 0.1, 0.1}}, {2, 3, 4}, {14, 17, 11}},
    {{{24, 25, 26}, {5e5, 0.1, -1e6}, {1.0 / 3, 0.7, 0.9}}, {2, 3, 4}, {14, 17, 11}},
    {{{40, 41, 42}, {0, 0, 0}, {1e-3, 1e-3, 1e-3}}, {3, 3, 3}, {35, 36, 37}},  // long triangles
};

// Samples inside faces have the value 0; all others on the surface are within the promised error.
void expect_zeros(const BoxOnGrid& box, double thickness, const ComputeOptions& options, const std::string& what) {
  SCOPED_TRACE(what);
  const DistanceField field = compute(box.mesh(), box.grid, thickness, options).field;
  const double allowed = 1e-6 * 16 * box.grid.max_spacing();
  int zeros = 0, others = 0, wrong = 0;
  for_each_sample(box.grid, [&](auto i, auto j, auto k) {
    const auto place = box.place(i, j, k);
    const float value = field.value(i, j, k);
    if (place == BoxOnGrid::Place::off) {
      wrong += value == 0;
    } else if (place == BoxOnGrid::Place::inside_of_a_face) {
      ++zeros;
      wrong += value != 0 || std::signbit(value);
    } else {
      ++others;
      wrong += !(std::abs(value) <= allowed);
    }
  });
  EXPECT_GT(zeros, 200);
  EXPECT_GT(others, 50);
  EXPECT_EQ(wrong, 0);
}

// The normal's component once differed from 1 by a rounding, and so the sample's height over the plane from 0: 81 of 81
// samples on the faces of a unit cube had 3.7e-9.
TEST(OnSurface, SamplesWithinFacesAcrossAnAxisHaveTheValueZero) {
  for (std::size_t n = 0; n < std::size(kBoxes); ++n) {
    const BoxOnGrid& box = kBoxes[n];
    const std::string name = "box " + std::to_string(n);
    for (const double spacings : {2.0, 10.0, kInfinity}) {
      const double thickness = spacings * box.grid.max_spacing();
      for (const Simd simd : {Simd::portable, Simd::automatic}) {
        ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = 1, .simd = simd}};
        expect_zeros(box, thickness, options, name + ", unsigned");
        options.sign.method = SignMethod::winding;
        expect_zeros(box, thickness, options, name + ", signed");
      }
    }
    ComputeOptions emulated{.sign = {SignMethod::none}, .execution = {.threads = 1, .backend = testing::kEmulated}};
    expect_zeros(box, 2 * box.grid.max_spacing(), emulated, name + ", emulated");
  }
}

// Whether a sample lies on a triangle whose corners are samples: whole numbers decide it.
bool lies_on(const std::array<std::array<std::int64_t, 3>, 3>& t, const std::array<std::int64_t, 3>& p) {
  const auto minus = [](const auto& a, const auto& b) {
    return std::array<std::int64_t, 3>{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  };
  const auto cross_of = [](const auto& a, const auto& b) {
    return std::array<std::int64_t, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto dot_of = [](const auto& a, const auto& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const auto normal = cross_of(minus(t[1], t[0]), minus(t[2], t[0]));
  if (dot_of(normal, normal) == 0 || dot_of(normal, minus(p, t[0])) != 0) return false;
  for (std::size_t n = 0; n < 3; ++n)
    if (dot_of(normal, cross_of(minus(t[(n + 1) % 3], t[n]), minus(p, t[n]))) < 0) return false;
  return true;
}

TEST(OnSurface, SamplesOnAnyTriangleAreWithinThePromise) {
  const Grid grid{{33, 34, 35}, {-3.5, 0.1, 1000}, {0.1, 0.1, 0.1}};
  Random random(1);
  int on = 0, zeros = 0;
  double worst = 0;
  for (int n = 0; n < 60; ++n) {
    // Corners within some samples of each other, or anywhere.
    const std::uint32_t reach = n % 2 ? 5 : 33;
    std::array<std::array<std::int64_t, 3>, 3> corners;
    Mesh mesh;
    const std::uint32_t from = random.below(33 - reach + 1);
    for (auto& corner : corners) {
      for (auto& at : corner) at = from + random.below(reach);
      mesh.vertices.push_back(grid.position(corner[0], corner[1], corner[2]));
    }
    mesh.triangles = {{0, 1, 2}};
    const DistanceField field =
        compute(mesh, grid, 3 * grid.max_spacing(), {.sign = {SignMethod::none}, .execution = {.threads = 1}}).field;
    for_each_sample(grid, [&](auto i, auto j, auto k) {
      if (!lies_on(corners, {i, j, k})) return;
      const double value = field.value(i, j, k);
      ++on, zeros += value == 0;
      worst = std::max(worst, value / grid.max_spacing());
    });
  }
  RecordProperty("worst", std::to_string(worst));
  std::printf("%d samples on triangles, %d of them 0, the others at most %.2g spacings\n", on, zeros, worst);
  EXPECT_GT(on, 200);
  EXPECT_LE(worst, 1e-6 * 16);
}

// A sample on the surface of a closed mesh has the sign of the point next to it in +y; if that is on the surface too,
// of the point in +z, then in +x.
TEST(OnSurface, WhereTheValueIsNotZeroItsSideIsThatOfThePointBeyondInY) {
  const BoxOnGrid& box = kBoxes[1];
  const DistanceField field = compute(box.mesh(), box.grid, kInfinity, {.sign = {.method = SignMethod::winding}}).field;
  int negative = 0, positive = 0;
  for_each_sample(box.grid, [&](auto i, auto j, auto k) {
    if (box.place(i, j, k) == BoxOnGrid::Place::off) return;
    const float value = field.value(i, j, k);
    if (value == 0) return;
    const bool inside = i < box.high[0] && j < box.high[1] && k < box.high[2];
    EXPECT_EQ(std::signbit(value), inside) << i << ' ' << j << ' ' << k;
    ++(value < 0 ? negative : positive);
  });
  EXPECT_GT(negative, 0);
  EXPECT_GT(positive, 0);
}

}  // namespace
}  // namespace standoff
