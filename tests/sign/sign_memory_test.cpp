// SPDX-License-Identifier: Apache-2.0
// estimate() of signed fields is an upper bound of what computing them holds, and no far one; at most a tenth above
// that of unsigned ones if nothing is to be diagnosed; and never a reason for a wrong sign.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/threads.h"
#include "field/plan.h"
#include "scenes/scenes.h"
#include "sign/plan.h"
#include "standoff/compute.h"
#include "standoff/testing/emulation.h"
#include "tests/sign/shapes.h"
#include "tests/sign/solid_soup.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"
#include "tests/support/heap.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {
namespace {

constexpr std::int64_t kSmallThings = 64 << 10;  // what TBB and the texts of a report take

ComputeOptions options_with(SignMethod method, int threads = 2) {
  return {.sign = {.method = method}, .execution = {.threads = threads, .backend = Backend::cpu}};
}

Mesh shells(int count) {
  std::vector<Tetrahedron> nested;
  for (int n = 1; n <= count; ++n) {
    const double s = 1.0 * n / count;
    nested.push_back({Vec3{-s, -s, -s}, Vec3{3 * s, -s, -s}, Vec3{-s, 3 * s, -s}, Vec3{-s, -s, 3 * s}});
  }
  return mesh_of(nested);
}
Mesh solids(int count, double size) {
  Random random(3);
  std::vector<Tetrahedron> all;
  for (int n = 0; n < count; ++n) {
    const Vec3 at = random.in_cube(1);
    all.push_back(
        {at + random.in_cube(size), at + random.in_cube(size), at + random.in_cube(size), at + random.in_cube(size)});
  }
  return mesh_of(all);
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
          const std::int64_t taken = heap::most_held([&] { compute(kind.mesh, grid, thickness, options); });
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

// Open meshes and others that need a diagnosis. Most are like those that people have; the others are the worst.
Mesh without_every(int nth, Mesh mesh) {
  int n = 0;
  std::erase_if(mesh.triangles, [&](const Triangle&) { return ++n % nth == 0; });
  return mesh;
}
Mesh with_reversed(int nth, Mesh mesh) {
  int n = 0;
  for (Triangle& t : mesh.triangles)
    if (++n % nth == 0) std::swap(t[0], t[1]);
  return mesh;
}
Mesh two_sided(Mesh mesh) {
  const Mesh front = mesh;
  for (const auto& [a, b, c] : front.triangles) mesh.triangles.push_back({a, c, b});
  return mesh;
}
Mesh inside_out(Mesh mesh) { return with_reversed(1, std::move(mesh)); }
// Pages around one edge.
Mesh book(std::uint32_t pages) {
  Mesh mesh{{{0, 0, -1}, {0, 0, 1}}, {}};
  for (std::uint32_t n = 0; n < pages; ++n) {
    const double angle = kTurn * n / pages;
    mesh.vertices.push_back({std::cos(angle), std::sin(angle), 0});
    mesh.triangles.push_back({0, 1, 2 + n});
  }
  return mesh;
}

std::vector<Kind> usual_kinds() {
  const Mesh ball = sphere(80);
  return {{"terrain", terrain(120)},
          {"terrain, nothing shared", unwelded(terrain(120))},
          {"a ball with a hole", without_every(20'000, ball)},
          {"a ball with many holes", without_every(200, ball)},
          {"a ball of reversed triangles", with_reversed(7, ball)},
          {"a ball with holes, reversed", with_reversed(7, without_every(500, ball))},
          {"a ball with two sides", two_sided(without_every(500, ball))},
          {"a ball inside out", inside_out(ball)},
          {"plane", scenes::make("plane", 40'000)},
          {"an assembly with an open chute", scenes::make("our_process", 40'000)}};
}
std::vector<Kind> worst_kinds() {
  return {{"a third is missing", without_every(3, sphere(40))},
          {"a soup", random_soup(5, 3000, 1, 0.1)},
          {"a nasty soup", nasty_soup(5, 3000, 5)},
          {"a dense nasty soup", nasty_soup(5, 3000, 2)},
          {"a book", book(3000)},
          {"shells inside out", inside_out(shells(500))},
          {"solids through each other inside out", inside_out(solids(200, 1))},
          {"a solid twice, half reversed", with_reversed(2, two_sided(sphere(20)))}};
}

// What planning takes; `said` what was said.
std::int64_t planning_of(const Mesh& mesh, const SignOptions& options, int threads, std::int64_t& said) {
  return Threads(threads).run([&] {
    said = sign_memory(mesh, options, threads).planning;
    ProgressMeter nobody;
    return heap::most_held([&] { plan_sign(mesh, options, nobody); });
  });
}

TEST(SignMemory, ADiagnosisTakesWhatWasSaid) {
  std::int64_t said = 0;
  for (const int threads : {1, 4}) {
    for (const Kind& kind : usual_kinds()) {
      const std::int64_t taken = planning_of(kind.mesh, {}, threads, said);
      EXPECT_LE(taken, said + kSmallThings) << kind.name;
      EXPECT_LE(said, 3 * taken / 2) << kind.name;
    }
    for (const Kind& kind : worst_kinds())
      for (const bool as_oriented : {false, true})
        for (const SignMethod method : {SignMethod::automatic, SignMethod::winding}) {
          const SignOptions options{.method = method, .as_oriented = as_oriented};
          const std::int64_t taken = planning_of(kind.mesh, options, threads, said);
          EXPECT_LE(taken, said + kSmallThings) << kind.name;
          const auto triangles = static_cast<std::int64_t>(kind.mesh.triangles.size());
          EXPECT_LE(said, most_sign_memory(triangles, options, threads).planning) << kind.name;
        }
  }
}

// A limit once had to be 3.6 times what was taken; and soups took more than was said. In finer grids, the field takes
// the most, and its tiles come in chunks that double.
TEST(SignMemory, FieldsOfOpenMeshesTakeWhatWasSaid) {
  for (const Kind& kind : usual_kinds()) {
    // Of cubic spacing: in 4 to 16 of the smallest spacings, what is said is the most that two algorithms take.
    const Grid grid = fit_resolution(bounds(kind.mesh), 64);
    const ComputeOptions options = options_with(SignMethod::automatic);
    const double thickness = 2 * grid.max_spacing();
    const std::int64_t said = estimate(kind.mesh, grid, thickness, options).whole;
    const std::int64_t taken = heap::most_held([&] { compute(kind.mesh, grid, thickness, options); });
    EXPECT_LE(taken, said + kSmallThings) << kind.name;
    EXPECT_LE(said, 3 * taken / 2) << kind.name;
  }
  for (const Kind& kind : worst_kinds())
    for (const SignMethod method : {SignMethod::automatic, SignMethod::winding})
      for (const int threads : {1, 4}) {
        const Grid grid = grid_of(kind.mesh, {16, 24, 20});
        const ComputeOptions options = options_with(method, threads);
        const std::int64_t said = estimate(kind.mesh, grid, grid.max_spacing(), options).whole;
        const std::int64_t taken = heap::most_held([&] { compute(kind.mesh, grid, grid.max_spacing(), options); });
        EXPECT_LE(taken, said + kSmallThings) << kind.name << ", sign " << name_of(method);
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
    const heap::Limit hard(options.memory_limit + kSmallThings);
    limited = compute(mesh, grid, grid.max_spacing(), options).field;
  }
  EXPECT_EQ(bits_of(limited.to_dense()), bits_of(whole));
  options.memory_limit -= 1;
  expect_error([&] { compute(mesh, grid, grid.max_spacing(), options); }, ErrorCode::limit, "more than the limit");
}

// The memory of an emulated device counts.
ComputeOptions on_device(SignMethod method) {
  ComputeOptions options = options_with(method);
  options.execution.backend = kEmulated;
  options.nearest = true;
  return options;
}

TEST(SignMemory, ASignByADeviceTakesNoMoreThanWasSaid) {
  Mesh with_hole = sphere(30);
  with_hole.triangles.pop_back();
  for (const Kind& kind :
       {Kind{"a ball", sphere(30)}, {"a ball with a hole", with_hole}, {"many small ones", solids(300, 0.02)}})
    for (const double samples : {2.0, kInfinity}) {
      const Grid grid = grid_of(kind.mesh, {24, 24, 24});
      const double thickness = samples * grid.max_spacing();
      const std::int64_t needed = estimate(kind.mesh, grid, thickness, on_device(SignMethod::automatic)).whole;
      const std::int64_t taken =
          heap::most_held([&] { compute(kind.mesh, grid, thickness, on_device(SignMethod::automatic)); });
      EXPECT_LE(taken, needed + kSmallThings) << kind.name << ", " << samples;
    }
}

TEST(SignMemory, ASignByADeviceIsCounted) {
  const Mesh solid = solids(1, 1);
  const Grid grid = grid_of(solid, {400, 400, 400});
  // A byte for each sample is more than the lists of a thin band of few triangles.
  const double thickness = 2 * grid.max_spacing();
  EXPECT_GT(estimate(solid, grid, thickness, on_device(SignMethod::automatic)).dense,
            estimate(solid, grid, thickness, on_device(SignMethod::none)).dense);
  // Where the device has doubts, the sign is planned beside the output; else before there is any.
  constexpr std::int64_t kPlanning = std::int64_t{1} << 40;
  const auto needed = [&](const ComputeOptions& options) {
    return bytes_needed(make_plan(4, grid, 2, options, true), {}, {.planning = kPlanning});
  };
  EXPECT_GE(needed(on_device(SignMethod::automatic)), kPlanning + 8 * grid.sample_count());
  EXPECT_EQ(needed(on_device(SignMethod::flood)), kPlanning);
}

}  // namespace
}  // namespace standoff::testing
