// SPDX-License-Identifier: Apache-2.0
// Fields in tests: computed in one line, gone through sample by sample, compared with the reference and bit by bit.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

#include "standoff/compute.h"
#include "tests/support/reference.h"

namespace standoff::testing {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Use>
void for_each_sample(const Grid& grid, Use use) {
  for (std::int64_t k = 0; k < grid.size.z; ++k)
    for (std::int64_t j = 0; j < grid.size.y; ++j)
      for (std::int64_t i = 0; i < grid.size.x; ++i) use(i, j, k);
}

/// The field and its nearest triangles, by two threads.
inline ComputeResult computed(MeshView mesh, const Grid& grid, double thickness, Simd simd = Simd::automatic,
                              int threads = 2) {
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = threads, .simd = simd}, .nearest = true};
  return compute(mesh, grid, thickness, options);
}

inline std::vector<std::uint32_t> all_nearest(const DistanceField& field) {
  std::vector<std::uint32_t> nearest(static_cast<std::size_t>(field.grid().sample_count()));
  field.copy_nearest_slices(0, field.grid().size.z, nearest);
  return nearest;
}

/// The values' bits: NaN equals itself, and +0 differs from -0.
inline std::vector<std::uint32_t> bits_of(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits;
  bits.reserve(values.size());
  for (const float value : values) bits.push_back(std::bit_cast<std::uint32_t>(value));
  return bits;
}

/// The distance by definition at every sample, x fastest.
inline std::vector<double> reference_distances(MeshView mesh, const Grid& grid) {
  std::vector<double> distances;
  for_each_sample(
      grid, [&](auto i, auto j, auto k) { distances.push_back(reference_distance(mesh, grid.position(i, j, k))); });
  return distances;
}

/// Every value within the promise, every nearest triangle as near as the nearest, none exactly beyond the thickness.
inline void expect_exact(MeshView mesh, const DistanceField& field, const std::vector<double>& distances) {
  const Grid& grid = field.grid();
  const double thickness = field.thickness();
  double worst = 0;
  std::string where;
  std::int64_t nearest_wrong = 0;
  for_each_sample(grid, [&](auto i, auto j, auto k) {
    const double distance = distances[static_cast<std::size_t>(grid.index(i, j, k))];
    const double expected = std::min(distance, thickness), allowed = promised_error(grid, expected);
    const double error = std::abs(field.value(i, j, k) - expected) / allowed;
    if (!(error <= worst)) {
      worst = std::isnan(error) ? kInfinity : error;
      where = std::to_string(i) + ' ' + std::to_string(j) + ' ' + std::to_string(k) + ": value " +
              std::to_string(field.value(i, j, k)) + ", distance " + std::to_string(distance);
    }
    if (!field.has_nearest()) return;
    const std::uint32_t nearest = field.nearest(i, j, k);
    if (nearest == kNoTriangle)
      nearest_wrong += distance < thickness - allowed || field.value(i, j, k) != static_cast<float>(thickness);
    else
      nearest_wrong += distance > thickness + allowed || nearest >= mesh.triangles.size() ||
                       reference_distance(mesh, nearest, grid.position(i, j, k)) > distance + 2 * allowed;
  });
  EXPECT_LE(worst, 1) << "largest error in terms of the promised one; sample " << where;
  EXPECT_EQ(nearest_wrong, 0);
}

/// The same for fields of these thicknesses, in units of the largest spacing.
inline void expect_exact(MeshView mesh, const Grid& grid, std::initializer_list<double> thicknesses,
                         Simd simd = Simd::automatic) {
  const std::vector<double> distances = reference_distances(mesh, grid);
  for (const double thickness : thicknesses) {
    SCOPED_TRACE("thickness " + std::to_string(thickness) + " spacings");
    expect_exact(mesh, computed(mesh, grid, thickness * grid.max_spacing(), simd).field, distances);
  }
}

inline void expect_same_bits(const DistanceField& a, const DistanceField& b) {
  ASSERT_EQ(a.grid().size, b.grid().size);
  EXPECT_TRUE(bits_of(a.to_dense()) == bits_of(b.to_dense())) << "values differ";
  ASSERT_EQ(a.has_nearest(), b.has_nearest());
  if (!a.has_nearest()) return;
  EXPECT_TRUE(all_nearest(a) == all_nearest(b)) << "nearest triangles differ";
}

}  // namespace standoff::testing
