// SPDX-License-Identifier: Apache-2.0
#include "render/slice.h"

#include <gtest/gtest.h>

#include "standoff/compute.h"
#include "standoff/io.h"
#include "standoff/slice.h"

namespace standoff {
namespace {

// A field of a function of the world.
template <class Distance>
DistanceField sampled(const Size3& size, Vec3 spacing, double thickness, const Distance& distance) {
  std::vector<float> values;
  for (std::int64_t k = 0; k < size.z; ++k)
    for (std::int64_t j = 0; j < size.y; ++j)
      for (std::int64_t i = 0; i < size.x; ++i) {
        const double d = distance(static_cast<double>(i) * spacing.x, static_cast<double>(j) * spacing.y,
                                  static_cast<double>(k) * spacing.z);
        values.push_back(static_cast<float>(std::clamp(d, -thickness, thickness)));
      }
  return DistanceField::from_dense({size, {}, spacing}, thickness, values);
}

// The signed distance to a box, exact outside and inside.
struct BoxDistance {
  Vec3 center, half;
  double operator()(double x, double y, double z) const {
    const Vec3 q{std::abs(x - center.x) - half.x, std::abs(y - center.y) - half.y, std::abs(z - center.z) - half.z};
    const Vec3 out{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
    return length(out) + std::min(0.0, std::max({q.x, q.y, q.z}));
  }
};

void expect_plane(const DistanceField& field, Axis axis, std::int64_t index, const std::string& what) {
  const SlicePlane plane = slice_plane(field);
  EXPECT_EQ(plane.axis, axis) << what;
  EXPECT_EQ(plane.index, index) << what;
}

TEST(BestPlane, ABoxIsCutAlongItsLongestSides) {
  const Size3 size{41, 41, 41};
  const Vec3 center{20, 20, 20};
  const auto box = [&](Vec3 half, double thickness = 3) {
    return sampled(size, {1, 1, 1}, thickness, BoxDistance{center, half});
  };
  expect_plane(box({14, 10, 5}), Axis::z, 20, "the flat side down");
  expect_plane(box({14, 5, 10}), Axis::y, 20, "the flat side in front");
  expect_plane(box({5, 14, 10}), Axis::x, 20, "the flat side at the left");
  expect_plane(box({10, 10, 10}), Axis::z, 20, "a cube: no face, but its middle");
  expect_plane(box({14, 10, 5}, 100), Axis::z, 20, "a full field");
  expect_plane(box({14, 5, 10}, 0.9), Axis::y, 20, "a band of less than a spacing");
  const auto unsigned_box = [&](double x, double y, double z) {
    return std::abs(BoxDistance{center, {14, 5, 10}}(x, y, z));
  };
  expect_plane(sampled(size, {1, 1, 1}, 3, unsigned_box), Axis::y, 20, "without a sign");
}

TEST(BestPlane, LengthsAreThoseOfTheWorld) {
  // A box that is as deep as it is wide, on samples that are four times as dense in depth.
  const auto field = sampled({41, 41, 161}, {1, 1, 0.25}, 3, BoxDistance{{20, 20, 20}, {12, 6, 14}});
  expect_plane(field, Axis::y, 20, "x and z are the longer sides");
}

TEST(BestPlane, ItIsNotInTheMiddleOfTheGridButOfTheBody) {
  const auto field = sampled({41, 33, 50}, {1, 1, 1}, 2, BoxDistance{{25, 15, 36}, {10, 8, 4}});
  expect_plane(field, Axis::z, 36, "most of the grid is empty");
}

TEST(BestPlane, AFieldWithoutASurfaceShowsItsMiddle) {
  expect_plane(DistanceField({{9, 5, 7}, {}, {1, 1, 1}}, 2), Axis::z, 3, "nothing stored");
  expect_plane(DistanceField({{9, 5, 7}, {}, {1, 1, 1}}, kFullField), Axis::z, 3, "all infinite");
  expect_plane(DistanceField(), Axis::z, 0, "one sample");
}

TEST(BestPlane, WhatIsAskedForIsTaken) {
  const auto field = sampled({41, 41, 41}, {1, 1, 1}, 3, BoxDistance{{20, 20, 20}, {14, 5, 10}});
  const auto plane = [&](std::optional<Axis> axis, std::optional<double> at, std::optional<std::int64_t> index) {
    SliceOptions options;
    options.axis = axis;
    options.at = at;
    options.index = index;
    const SlicePlane chosen = slice_plane(field, options);
    return std::pair(chosen.axis, chosen.index);
  };
  EXPECT_EQ(plane(Axis::x, {}, {}), std::pair(Axis::x, std::int64_t{20}));
  EXPECT_EQ(plane(Axis::x, 0.25, {}), std::pair(Axis::x, std::int64_t{10}));
  EXPECT_EQ(plane(Axis::x, 0.25, 3), std::pair(Axis::x, std::int64_t{3}));
  EXPECT_EQ(plane({}, {}, 20), std::pair(Axis::y, std::int64_t{20}));
  EXPECT_EQ(plane({}, 0.2, {}), std::pair(Axis::x, std::int64_t{8})) << "there, only this axis meets the body";
  // An index that only a longer axis has is one of that axis.
  const DistanceField flat({{9, 5, 7}, {}, {1, 1, 1}}, 2);
  SliceOptions options;
  options.index = 8;
  EXPECT_EQ(slice_plane(flat, options).axis, Axis::x);
}

// The rabbit of the sample meshes is seen from the side, ears and all: z runs across it.
TEST(BestPlane, ARabbitIsSeenFromTheSide) {
  const std::filesystem::path bunny = "/usr/share/glmark2/models/bunny.obj";
  if (!std::filesystem::exists(bunny)) GTEST_SKIP() << "no rabbit here";
  const Mesh mesh = read_mesh(bunny).mesh;
  const Grid grid = fit_resolution(bounds(mesh), 64);
  for (const double thickness : {3 * grid.spacing.x, kFullField}) {
    const SlicePlane plane = slice_plane(compute(mesh, grid, thickness, {.sign = {SignMethod::none}}).field);
    EXPECT_EQ(plane.axis, Axis::z);
    EXPECT_LT(std::abs(plane.position), 0.15) << "through the body, not beside it";
  }
}

}  // namespace
}  // namespace standoff
