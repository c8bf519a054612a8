// SPDX-License-Identifier: Apache-2.0
// Several GPUs for one field, emulated: each takes windows of the grid, and the field has the bits of the whole.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "standoff/compute.h"
#include "standoff/testing/emulation.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using testing::kInfinity;

ComputeOptions on(std::vector<int> devices) {
  ComputeOptions options{.sign = {SignMethod::none}};
  options.nearest = true;
  options.execution.backend = testing::kEmulated;
  options.execution.threads = 2;
  options.devices = std::move(devices);
  return options;
}

TEST(Devices, ShareAFieldWithTheBitsOfTheWhole) {
  const Vec3 far{1e6, -3e5, 77};
  const Mesh near_mesh = testing::random_soup(61, 150, 6, 0.7), long_ones = testing::random_soup(62, 6, 8, 20),
             far_mesh = testing::random_soup(63, 60, 6, 1.5, far);
  // 1 to 5 layers of bricks, the last of them cut; the second grid has fewer layers than windows.
  const Grid grids[] = {{{13, 9, 71}, {-3, -2, -9}, {0.5, 0.55, 0.26}}, {{20, 9, 14}, {-5, -2, -3}, {0.5, 0.5, 0.5}}};
  for (const Mesh& mesh : {near_mesh, long_ones})
    for (const Grid& grid : grids)
      for (const double thickness : {0.9, 2.6, kInfinity}) {
        SCOPED_TRACE("thickness " + std::to_string(thickness));
        ComputeOptions on_cpu = on({});
        on_cpu.execution.backend = Backend::cpu;
        const ComputeResult whole = compute(mesh, grid, thickness, on_cpu);
        for (const std::vector<int>& devices : {std::vector{3}, {0, 1}, {2, 0, 1}}) {
          const ComputeResult shared = compute(mesh, grid, thickness, on(devices));
          testing::expect_same_bits(whole.field, shared.field);
          EXPECT_EQ(whole.report.samples_band, shared.report.samples_band);
          EXPECT_EQ(whole.field.stored_tiles(), shared.field.stored_tiles());
        }
      }
  Grid far_grid = grids[0];
  far_grid.origin = far_grid.origin + far;
  testing::expect_same_bits(compute(far_mesh, far_grid, 1, on({0})).field,
                            compute(far_mesh, far_grid, 1, on({0, 1})).field);
}

TEST(Devices, AreNamedInTheReport) {
  const Mesh mesh = testing::random_soup(64, 20, 2, 0.7);
  const Grid grid{{9, 9, 40}, {-2, -2, -2}, {0.5, 0.5, 0.1}};
  EXPECT_EQ(compute(mesh, grid, 1, on({0, 1})).report.device, "emulated on the CPU, emulated on the CPU");
}

TEST(Devices, TheFirstErrorEndsTheWork) {
  const Mesh mesh = testing::random_soup(65, 20, 2, 0.7);
  const Grid grid{{9, 9, 100}, {-2, -2, -2}, {0.5, 0.5, 0.1}};
  ComputeOptions options = on({0, 1});
  int calls = 0;
  options.progress = [&](const Progress& now) { return std::string(now.stage) != "distances" || ++calls < 3; };
  expect_error([&] { compute(mesh, grid, 1, options); }, ErrorCode::interrupted, "cancelled");
}

TEST(Devices, RefusesWhatItCannotShare) {
  const Mesh mesh = testing::random_soup(66, 20, 2, 0.7);
  const Grid grid{{9, 9, 9}, {-2, -2, -2}, {0.5, 0.5, 0.5}};
  const auto refuses = [&](ComputeOptions options, const std::string& words) {
    expect_error([&] { compute(mesh, grid, 1, options); }, ErrorCode::usage, words);
  };
  ComputeOptions options = on({0, 1});
  options.method = Method::thesis;
  refuses(options, "the method thesis takes one emulated device");
  refuses(on({0, 0}), "named twice");
  refuses(on({-1}), "device -1 does not exist");
  options = on({0, 1});
  options.execution.backend = Backend::cpu;
  refuses(options, "devices are GPUs by their numbers");
  options.execution.backend = Backend::automatic;
  refuses(options, "devices are GPUs by their numbers");
}

}  // namespace
}  // namespace standoff
