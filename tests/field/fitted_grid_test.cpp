// SPDX-License-Identifier: Apache-2.0
// The grid that is fitted for a thickness holds the whole band, if that is not wider than a tenth of the mesh. README's
// example once cut it off: the surface at half the thickness had 870 open edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "tests/support/fields.h"

namespace standoff {
namespace {

// The least value on the grid's faces.
float least_on_faces(const DistanceField& field) {
  const Size3 n = field.grid().size;
  float least = std::numeric_limits<float>::infinity();
  testing::for_each_sample(field.grid(), [&](auto i, auto j, auto k) {
    if (i == 0 || j == 0 || k == 0 || i == n.x - 1 || j == n.y - 1 || k == n.z - 1)
      least = std::min(least, field.value(i, j, k));
  });
  return least;
}

void expect_whole_band(const Mesh& mesh, const Grid& grid, double thickness) {
  SCOPED_TRACE("thickness " + std::to_string(thickness) + ", spacing " + std::to_string(grid.max_spacing()));
  const DistanceField field = compute(mesh, grid, thickness, {.sign = {SignMethod::none}}).field;
  EXPECT_GT(field.stored_tiles(), 0);
  // Faces lie as far away as the thickness: rounding decides which samples of a flat side are in the band.
  EXPECT_GE(least_on_faces(field), thickness * (1 - 1e-5));
}

TEST(FittedGrid, HoldsTheWholeBand) {
  for (const char* name : {"sphere", "box"}) {
    SCOPED_TRACE(name);
    const Mesh mesh = scenes::make(name, 300);
    const Box box = bounds(mesh);
    const Vec3 extent = box.extent();
    const double side = std::max({extent.x, extent.y, extent.z});
    for (const double thickness : {0.02 * side, 0.1 * side}) {
      expect_whole_band(mesh, fit_resolution(box, 40, thickness), thickness);
      const double h = side / 30;
      expect_whole_band(mesh, fit_spacing(box, {h, h / 2, h}, thickness), thickness);
      expect_whole_band(mesh, fit_size(box, {40, 20, 30}, thickness), thickness);
    }
    // The band may be given in samples.
    const Grid grid = fit_resolution(box, 40, {.samples = 3});
    expect_whole_band(mesh, grid, 3 * grid.spacing.x);
  }
}

TEST(FittedGrid, OfAFullFieldReachesBeyondTheMesh) {
  const Mesh mesh = scenes::make("sphere", 300);
  const Grid grid = fit_resolution(bounds(mesh), 40);
  EXPECT_GE(least_on_faces(compute(mesh, grid, kFullField, {.sign = {SignMethod::none}}).field),
            2 * grid.spacing.x * (1 - 1e-5));
}

}  // namespace
}  // namespace standoff
