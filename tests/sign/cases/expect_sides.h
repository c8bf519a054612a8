// SPDX-License-Identifier: Apache-2.0
// Compares what is said of every sample of a grid with what is known of it: fields, dense fields and voxels.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "standoff/compute.h"
#include "standoff/occupancy.h"
#include "tests/support/fields.h"

namespace standoff::testing {

/// What is known of a point. `unknown` is for points so close to a surface, or to the surface where the winding number
/// is 1/2, that rounding decides.
enum class Side { outside, inside, unknown };
constexpr Side side_of(bool inside) { return inside ? Side::inside : Side::outside; }

struct Compared {
  std::int64_t inside = 0, outside = 0, unknown = 0;  ///< samples, by what is known
  std::int64_t wrong = 0;                             ///< samples on the wrong side
  std::string first_wrong;
  SignReport report;

  std::int64_t known() const { return inside + outside; }
};

inline std::string text_of(Vec3 p) {
  return std::to_string(p.x) + ' ' + std::to_string(p.y) + ' ' + std::to_string(p.z);
}

inline bool has_voxels(SignMethod method) {
  return method == SignMethod::winding || method == SignMethod::parity || method == SignMethod::flood;
}

/// Computes the field with a sign. Its magnitudes must be those of the unsigned field, bit by bit, and its sides those
/// of the voxels and of the dense field. Counts the samples whose side is not that of known(position). Samples on the
/// surface, as far as a field resolves it, have no known side.
template <class Known>
Compared compare_sides(MeshView mesh, const Grid& grid, const SignOptions& sign, const Known& known,
                       double thickness = kFullField) {
  ComputeOptions options{.sign = {SignMethod::none}};
  const std::vector<float> plain = compute(mesh, grid, thickness, options).field.to_dense();
  options.sign = sign;
  const ComputeResult result = compute(mesh, grid, thickness, options);
  const std::vector<float> values = result.field.to_dense();
  std::vector<float> dense(values.size());
  compute_into(mesh, grid, thickness, dense, options);
  EXPECT_TRUE(bits_of(dense) == bits_of(values)) << "the dense field differs from the sparse one";

  Compared found;
  found.report = result.report.sign;
  EXPECT_TRUE(result.field.provenance().sign.starts_with(name_of(found.report.method)));
  std::int64_t other_magnitudes = 0, other_voxels = 0;
  const bool voxels = has_voxels(found.report.method);
  const Occupancy occupied = voxels ? occupancy(mesh, grid, {.sign = sign}) : Occupancy{};
  for_each_sample(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const auto n = static_cast<std::size_t>(grid.index(i, j, k));
    const Vec3 p = grid.position(i, j, k);
    const bool inside = values[n] < 0;
    const Side side = plain[n] <= promised_error(grid, 0) ? Side::unknown : known(p);
    ++(side == Side::unknown ? found.unknown : side == Side::inside ? found.inside : found.outside);
    other_magnitudes += std::bit_cast<std::uint32_t>(std::abs(values[n])) != std::bit_cast<std::uint32_t>(plain[n]);
    other_voxels += voxels && values[n] != 0 && occupied.inside(i, j, k) != inside;
    if (side == Side::unknown || inside == (side == Side::inside)) return;
    if (found.wrong++ == 0)
      found.first_wrong =
          text_of(p) + (inside ? " is inside" : " is outside") + " at distance " + std::to_string(plain[n]);
  });
  EXPECT_EQ(other_magnitudes, 0) << "values whose magnitude is not that of the unsigned field";
  EXPECT_EQ(other_voxels, 0) << "voxels that are not on the field's side";
  return found;
}

/// Expects the right side of every sample of which one is known, and that these are most.
template <class Known>
SignReport expect_sides(MeshView mesh, const Grid& grid, const SignOptions& sign, const Known& known,
                        double thickness = kFullField) {
  const Compared found = compare_sides(mesh, grid, sign, known, thickness);
  EXPECT_EQ(found.wrong, 0) << "of " << found.known() << "; " << found.first_wrong << "; " << name_of(sign.method)
                            << ": " << found.report.why;
  EXPECT_GE(found.known(), std::min<std::int64_t>(grid.sample_count() / 2, 1000))
      << "too little is known to show anything";
  return found.report;
}

/// A grid of `samples` per side, a little larger than the mesh, whose samples are on no plane that a mesh made by
/// numbers is likely to have.
inline Grid grid_around(MeshView mesh, std::int64_t samples, double margin = 0.15) {
  const Box box = bounds(mesh);
  const double side = box.longest_side();
  const Vec3 low = box.min - Vec3{1.013, 1.037, 0.991} * (margin * side);
  const Vec3 extent = box.max + Vec3{1.007, 0.983, 1.021} * (margin * side) - low;
  return {{samples, samples, samples}, low, extent * (1.0 / double(samples - 1))};
}

}  // namespace standoff::testing
