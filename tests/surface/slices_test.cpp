// SPDX-License-Identifier: Apache-2.0
// A surface of slices that are read a few at a time is that of the whole field, bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "standoff/surface.h"
#include "tests/support/expect_error.h"
#include "tests/surface/random_field.h"

namespace standoff {
namespace {

using namespace testing;

// Of a field that is held, as fields of these slices; counts the most that are read at once.
class Slices {
 public:
  explicit Slices(const DistanceField& field) : field_(field) {}

  DistanceField operator()(std::int64_t first, std::int64_t count) {
    most_ = std::max(most_, count);
    const Grid& grid = field_.grid();
    const Grid part = grid.window({0, 0, first}, {grid.size.x, grid.size.y, count});
    std::vector<float> values(static_cast<std::size_t>(part.sample_count()));
    field_.copy_slices(first, count, values);
    return DistanceField::from_dense(part, field_.thickness(), values);
  }
  std::int64_t most() const { return most_; }

 private:
  const DistanceField& field_;
  std::int64_t most_ = 0;
};

std::vector<std::uint64_t> bits_of(const std::vector<Vec3>& points) {
  std::vector<std::uint64_t> bits;
  for (const Vec3& p : points)
    for (const double c : {p.x, p.y, p.z}) bits.push_back(std::bit_cast<std::uint64_t>(c));
  return bits;
}

void expect_same(const DistanceField& field, const SurfaceOptions& options, std::int64_t slices) {
  const SurfaceResult whole = surface(field, options);
  Slices read(field);
  const Grid& grid = field.grid();
  const SurfaceResult found =
      surface(grid, field.thickness(), std::ref(read), options, slices * grid.size.x * grid.size.y);
  EXPECT_TRUE(bits_of(found.mesh.vertices) == bits_of(whole.mesh.vertices));
  EXPECT_TRUE(found.mesh.triangles == whole.mesh.triangles);
  EXPECT_EQ(found.report.ambiguous_faces, whole.report.ambiguous_faces);
  EXPECT_EQ(found.report.clamped, whole.report.clamped);
  EXPECT_EQ(found.report.capped, whole.report.capped);
  EXPECT_EQ(found.report.floats, whole.report.floats);
  EXPECT_EQ(found.report.clearance, whole.report.clearance);
  EXPECT_LE(read.most(), std::max<std::int64_t>(8, slices / 8 * 8) + 16);
}

TEST(SurfaceOfSlices, OfNoise) {
  const Grid grids[] = {{{17, 10, 9}, {}, {1, 1, 1}},           {{9, 9, 50}, {1000, -2000, 0.1}, {0.1, 0.1, 0.1}},
                        {{3, 1, 130}, {}, {2, 2, 2}},           {{7, 10, 33}, {1e9, 1e9, -1e9}, {0.5, 0.5, 0.5}},
                        {{16, 8, 64}, {0, 0, -3}, {1, 2, 0.1}}, {{1, 1, 1}, {}, {1, 1, 1}}};
  for (const Grid& grid : grids)
    for (const Noise noise : {Noise::smooth, Noise::integers, Noise::extremes})
      for (const std::int64_t slices : {1, 8, 17, 24, 1000}) {
        SCOPED_TRACE(std::to_string(grid.size.z) + " slices, " + std::to_string(slices) + " at a time");
        const DistanceField field = noise_field(grid, noise, static_cast<unsigned>(slices));
        for (const double level : {0.0, 0.25, -1.0}) expect_same(field, {.at = level}, slices);
      }
}

TEST(SurfaceOfSlices, OfBands) {
  const Mesh mesh = scenes::make("fly");
  const Grid grid = fit_resolution(bounds(mesh), 90);
  for (const Coordinates coordinates : {Coordinates::automatic, Coordinates::full}) {
    const DistanceField field = compute(mesh, grid, 3 * grid.spacing.x).field;
    expect_same(field, {.at = grid.spacing.x, .coordinates = coordinates}, 8);
    expect_same(field, {.at = -grid.spacing.x / 2, .coordinates = coordinates}, 30);
  }
}

TEST(SurfaceOfSlices, TheUnlikelyAndTheWrong) {
  const DistanceField field = noise_field({{8, 8, 40}, {}, {1, 1, 1}}, Noise::smooth, 1);
  const Grid& grid = field.grid();
  Slices good(field);
  const auto refused = [&](const SurfaceOptions& options, const SliceReader& read, std::int64_t samples,
                           const char* why) {
    expect_error([&] { surface(grid, field.thickness(), read, options, samples); }, ErrorCode::usage, why);
  };
  refused({.method = SurfaceMethod::dual}, std::ref(good), 1000, "no dual contouring");
  refused({.at = 0.5, .wall = 1}, std::ref(good), 1000, "no walls");
  refused({}, std::ref(good), 0, "without samples");
  refused(
      {}, [&](std::int64_t first, std::int64_t count) { return good(first, count - 1); }, 64, "others came");
  refused(
      {}, [&](std::int64_t first, std::int64_t count) { return good(std::min<std::int64_t>(first, 8), count); }, 640,
      "others came");
  struct OfTheCaller {};
  EXPECT_THROW(surface(grid, kFullField, [](std::int64_t, std::int64_t) -> DistanceField { throw OfTheCaller(); }),
               OfTheCaller);
}

}  // namespace
}  // namespace standoff
