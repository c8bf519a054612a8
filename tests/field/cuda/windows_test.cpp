// SPDX-License-Identifier: Apache-2.0
// Windows on a GPU: a job for each, on one device and on several, with the bits of the CPU's whole field.
#include "standoff/windows.h"

#include <gtest/gtest.h>

#include <bit>
#include <vector>

#include "standoff/testing/emulation.h"
#include "tests/collision/bodies.h"

namespace standoff::testing {
namespace {

const Grid kGrid{{45, 37, 51}, {1000.1, -20000.3, 0.7}, {0.057, 0.071, 0.052}};

ComputeOptions on(Backend backend, std::vector<int> devices = {}) {
  ComputeOptions options{.sign = {SignMethod::winding}, .nearest = true};
  options.execution = {.threads = 2, .backend = backend};
  options.devices = std::move(devices);
  return options;
}

TEST(WindowsOnGpus, ArePartsOfTheWholeField) {
  const Mesh mesh = ball_mesh(1, 3, kGrid.position(22, 18, 25));
  for (const double thickness : {0.08, 0.7, kFullField})
    for (const std::vector<int>& devices : {std::vector<int>{}, std::vector<int>{0, 1}}) {
      const DistanceField whole = compute(mesh, kGrid, thickness, on(Backend::cpu)).field;
      WindowComputation windows(mesh, kGrid, thickness, {32, 32, 48}, on(kEmulated, devices));
      EXPECT_FALSE(windows.is_whole());
      DistanceField field;
      for (const Size3& first : {Size3{0, 0, 0}, Size3{16, 0, 0}, Size3{32, 16, 32}, Size3{3, 5, 7}}) {
        const Size3 size{std::min<std::int64_t>(32, kGrid.size.x - first.x),
                         std::min<std::int64_t>(21, kGrid.size.y - first.y),
                         std::min<std::int64_t>(48, kGrid.size.z - first.z)};
        windows.compute(first, size, field);
        std::int64_t wrong = 0;
        for (std::int64_t k = 0; k < size.z; ++k)
          for (std::int64_t j = 0; j < size.y; ++j)
            for (std::int64_t i = 0; i < size.x; ++i) {
              const std::int64_t x = first.x + i, y = first.y + j, z = first.z + k;
              wrong += std::bit_cast<std::uint32_t>(field.value(i, j, k)) !=
                           std::bit_cast<std::uint32_t>(whole.value(x, y, z)) ||
                       field.nearest(i, j, k) != whole.nearest(x, y, z);
            }
        EXPECT_EQ(wrong, 0) << thickness << ", " << devices.size() << " devices, from " << first.x;
      }
    }
}

}  // namespace
}  // namespace standoff::testing
