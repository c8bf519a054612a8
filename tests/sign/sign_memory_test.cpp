// SPDX-License-Identifier: Apache-2.0
// estimate() of signed fields is an upper bound of what computing them holds, at most a tenth above that of
// unsigned ones, and never a reason for a wrong sign.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "tests/sign/solid_soup.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"
#include "tests/support/heap.h"

namespace standoff {
namespace {

using testing::kInfinity;
using testing::Random;
using testing::Tetrahedron;

constexpr std::int64_t kSmallThings = 64 << 10;  // what TBB and the texts of a report take

ComputeOptions options_with(SignMethod method, int threads = 2) {
  ComputeOptions options{.sign = {SignMethod::none}};
  options.execution.backend = Backend::cpu;
  options.execution.threads = threads;
  options.sign.method = method;
  return options;
}

Mesh shells(int count) {
  std::vector<Tetrahedron> nested;
  for (int n = 1; n <= count; ++n) {
    const double s = 1.0 * n / count;
    nested.push_back({Vec3{-s, -s, -s}, Vec3{3 * s, -s, -s}, Vec3{-s, 3 * s, -s}, Vec3{-s, -s, 3 * s}});
  }
  return testing::mesh_of(nested);
}
Mesh solids(int count, double size) {
  Random random(3);
  std::vector<Tetrahedron> all;
  for (int n = 0; n < count; ++n) {
    const Vec3 at = random.in_cube(1);
    all.push_back(
        {at + random.in_cube(size), at + random.in_cube(size), at + random.in_cube(size), at + random.in_cube(size)});
  }
  return testing::mesh_of(all);
}

struct Kind {
  std::string name;
  Mesh mesh;
};
std::vector<Kind> kinds() {
  return {{"one solid", solids(1, 1)},
          {"many small ones", solids(2000, 0.02)},
          {"many large ones", solids(200, 1)},
          {"shells", shells(500)},
          {"catapult", scenes::make("catapult", 5000)}};
}

Grid grid_of(const Mesh& mesh, Size3 size) {
  const Box box = bounds(mesh);
  const Vec3 extent = box.extent();
  return {size, box.min, extent / Vec3{double(size.x), double(size.y), double(size.z)}};
}

TEST(SignMemory, NoFieldTakesMoreThanWasSaid) {
  for (const Kind& kind : kinds())
    for (const Size3 size : {Size3{40, 40, 40}, Size3{200, 9, 3}})
      for (const double samples : {0.1, 2.0, kInfinity})
        for (const int threads : {1, 4}) {
          const Grid grid = grid_of(kind.mesh, size);
          const ComputeOptions options = options_with(SignMethod::winding, threads);
          const double thickness = samples * grid.max_spacing();
          const std::int64_t needed = estimate(kind.mesh, grid, thickness, options).whole;
          const std::int64_t taken = testing::heap::most_held([&] { compute(kind.mesh, grid, thickness, options); });
          EXPECT_LE(taken, needed + kSmallThings) << kind.name << ", " << size.x << ", " << samples << " samples";
        }
}

TEST(SignMemory, ATenthMoreThanUnsigned) {
  for (const Kind& kind : kinds())
    for (const std::int64_t side : {100, 300}) {
      const Grid grid = grid_of(kind.mesh, {side, side, side});
      for (const double samples : {2.0, kInfinity}) {
        const double thickness = samples * grid.max_spacing();
        // Of a mesh of so many triangles that may be anywhere: crossings may take what the backend took before.
        const auto count = static_cast<std::int64_t>(kind.mesh.triangles.size());
        const std::int64_t plain = estimate(count, grid, thickness, options_with(SignMethod::none)).whole,
                           with_sign = estimate(kind.mesh, grid, thickness, options_with(SignMethod::winding)).whole;
        EXPECT_LE(static_cast<double>(with_sign), 1.1 * static_cast<double>(plain)) << kind.name << ", " << side;
      }
    }
}

// Shells with 2 crossings in each row: more than the memory that unsigned fields take. With no more than that
// the crossings come in parts; the field is the same.
TEST(SignMemory, ALimitChangesNoSign) {
  const Mesh mesh = shells(1000);
  const Grid grid = grid_of(mesh, {30, 60, 60});
  ComputeOptions options = options_with(SignMethod::parity);
  const std::vector<float> whole = compute(mesh, grid, grid.max_spacing(), options).field.to_dense();
  options.memory_limit = estimate(mesh, grid, grid.max_spacing(), options).whole;
  EXPECT_LT(options.memory_limit, std::int64_t{16} * 2 * 1000 * 60 * 60 / 2) << "half of all crossings";
  DistanceField limited;
  {
    const testing::heap::Limit hard(options.memory_limit + kSmallThings);
    limited = compute(mesh, grid, grid.max_spacing(), options).field;
  }
  EXPECT_EQ(testing::bits_of(limited.to_dense()), testing::bits_of(whole));
  options.memory_limit -= 1;
  expect_error([&] { compute(mesh, grid, grid.max_spacing(), options); }, ErrorCode::limit, "more than the limit");
}

}  // namespace
}  // namespace standoff
