// SPDX-License-Identifier: Apache-2.0
// The memory limit of surfaces: what is taken stays below it, and where it does not suffice nothing much is taken.
#include <gtest/gtest.h>

#include <vector>

#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "standoff/surface.h"
#include "tests/support/expect_error.h"
#include "tests/support/heap.h"

namespace standoff {
namespace {

namespace heap = testing::heap;

// Threads, tables of cells, and what every call takes.
constexpr std::int64_t kSmallThings = std::int64_t{1} << 20;

struct Case {
  const char* name;
  bool of_mesh;
  SurfaceOptions options;
};

std::vector<Case> cases() {
  const SurfaceOptions cubes{.sign = {SignMethod::winding}, .execution = {.threads = 2, .backend = Backend::cpu}};
  SurfaceOptions dual = cubes, hollow = cubes, offset;
  dual.method = SurfaceMethod::dual;
  hollow.wall = 0.1;
  offset = dual;
  offset.at = 0.05;
  return {{"field, marching cubes", false, cubes}, {"field, dual", false, dual}, {"field, hollow", false, hollow},
          {"mesh, marching cubes", true, cubes},   {"mesh, dual", true, dual},   {"mesh, offset", true, offset}};
}

TEST(SurfaceMemory, StaysBelowItsLimit) {
  const Mesh mesh = scenes::make("sphere", 2000);
  const Grid grid = fit_resolution(bounds(mesh), 96, 0.3);
  ComputeOptions computed{.sign = {.method = SignMethod::winding},
                          .execution = {.threads = 2, .backend = Backend::cpu}};
  const DistanceField field = compute(mesh, grid, 0.3, computed).field;
  for (Case& one : cases()) {
    SCOPED_TRACE(one.name);
    const auto make = [&] { return one.of_mesh ? surface(mesh, grid, one.options) : surface(field, one.options); };
    one.options.memory_limit = kNoMemoryLimit;
    const SurfaceResult whole = make();
    // From little to plenty: in between each step of the work is the first one that there is no memory for.
    int refused = 0, made = 0;
    for (std::int64_t limit = 1 << 14; made < 2; limit += limit / 4) {
      one.options.memory_limit = limit;
      const std::int64_t most = heap::most_held([&] {
        try {
          const SurfaceResult found = make();
          EXPECT_EQ(found.mesh.vertices, whole.mesh.vertices);
          ++made;
        } catch (const Error& error) {
          EXPECT_EQ(error.code(), ErrorCode::limit) << error.what();
          ++refused;
        }
      });
      EXPECT_LE(most, limit + kSmallThings) << limit;
      ASSERT_LT(limit, std::int64_t{1} << 32);
    }
    EXPECT_GT(refused, 5);
  }
}

TEST(SurfaceMemory, SaysWhatItNeeds) {
  const Mesh mesh = scenes::make("sphere", 2000);
  const Grid grid = fit_resolution(bounds(mesh), 96, 0.3);
  ComputeOptions computed{.sign = {.method = SignMethod::winding}, .execution = {.backend = Backend::cpu}};
  const DistanceField field = compute(mesh, grid, 0.3, computed).field;
  expect_error([&] { surface(field, {.memory_limit = 1000}); }, ErrorCode::limit, "memory limit");
  EXPECT_NO_THROW(surface(field, {.memory_limit = kNoMemoryLimit}));
  expect_error([&] { surface(mesh, grid, {.sign = {SignMethod::winding}, .memory_limit = 1000}); }, ErrorCode::limit,
               "limit");
}

}  // namespace
}  // namespace standoff
