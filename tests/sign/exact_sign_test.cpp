// SPDX-License-Identifier: Apache-2.0
// The sign of closed meshes is exact: at random samples, and at samples on the surface and units in the last place
// beside it. What is right is known in closed form, or from rays along another axis that share no code with src/sign
// (field/reference.h, which tests/field/winding_reference_test.cpp holds against integers).
//
// STANDOFF_CHECK_SIGNS: samples of each mesh; half of them random, half beside the surface. STANDOFF_CHECK_SEED: the
// first seed. With the former all scenes are tested, in their own sizes, and the bunny of glmark2 where it is.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/number_text.h"
#include "scenes/scenes.h"
#include "sign/diagnosis/closed.h"
#include "standoff/io.h"
#include "tests/collision/zoo/ask.h"
#include "tests/sign/shapes.h"
#include "tests/sign/sides_of_samples.h"
#include "tests/sign/solid_soup.h"

namespace standoff {
namespace {

using testing::Random;
using testing::Sides;
using testing::SidesOfSamples;

// How many boxes hold p, by comparisons.
ReferenceWinding in_boxes(const std::vector<Box>& boxes, const Vec3& p) {
  ReferenceWinding winding;
  for (const Box& box : boxes) {
    if (min(box.min, p) != box.min || max(box.max, p) != box.max) continue;
    const bool on = p.x == box.min.x || p.x == box.max.x || p.y == box.min.y || p.y == box.max.y || p.z == box.min.z ||
                    p.z == box.max.z;
    if (on) winding.on_surface = true;
    winding.value += !on;
  }
  return winding;
}

Mesh mesh_of(const std::vector<Box>& boxes) {
  Mesh mesh;
  for (const Box& box : boxes) testing::append(mesh, testing::box(box.min, box.max));
  return mesh;
}

// Samples on faces, edges and corners, and all of them moved by one unit in the last place to each side.
TEST(ExactSign, BoxesThatTheGridIsAlignedWith) {
  for (const double at : {0.0, 1e6, -3e15})
    for (const double size : {1.0, 0x1p-40, 0x1p60}) {
      const auto box = [&](double low, double high) {
        return Box{Vec3{1, 1, 1} * (at + low) * size, Vec3{1, 1, 1} * (at + high) * size};
      };
      // Faces of the third and the first lie upon each other.
      const std::vector<Box> boxes{box(0, 4), box(2, 6), box(4, 8), box(1, 3)};
      const SidesOfSamples sides(mesh_of(boxes));
      Sides all;
      for (int move = 0; move < 27; ++move) {
        const auto moved = [&](int by) {
          const double corner = (at - 1) * size;
          const double up = std::nextafter(corner, 1e300) - corner;
          return corner + up * (by - 1);
        };
        const Grid grid{{11, 11, 11}, {moved(move % 3), moved(move / 3 % 3), moved(move / 9)}, {size, size, size}};
        all += sides.compare(grid, [&](const Vec3& p) { return in_boxes(boxes, p); });
      }
      EXPECT_EQ(all.wrong, 0) << at << ", " << size;
      EXPECT_GT(all.inside, 1000);
      EXPECT_GT(all.on_surface, 100);
    }
}

TEST(ExactSign, ThousandsOfNestedShells) {
  std::vector<Box> shells;
  for (int n = 1; n <= 3000; ++n) shells.push_back({Vec3{-1, -1, -1} * n, Vec3{1, 1, 1} * n});
  const Mesh mesh = mesh_of(shells);
  const auto known = [](const Vec3& p) {
    const double depth = max_norm(p);
    ReferenceWinding winding;
    winding.on_surface = depth == std::floor(depth) && depth <= 3000;
    winding.value = std::max(0.0, 3000 - std::floor(depth));
    return winding;
  };
  for (const WindingRule rule : {WindingRule::positive, WindingRule::odd}) {
    const SidesOfSamples sides(mesh, {.method = SignMethod::winding, .rule = rule, .as_oriented = true});
    Sides all = sides.compare({{100, 3, 3}, {-3010.25, -1.5, -1.5}, {40.5, 1.25, 1.25}}, known);
    all += sides.compare({{100, 2, 2}, {2970.3, 2.5, 2.5}, {0.5, 17, 2900}}, known);
    EXPECT_EQ(all.wrong, 0);
    EXPECT_GT(all.inside, 100);
    EXPECT_GT(all.outside, 20);
  }
}

std::vector<testing::Tetrahedron> tetrahedra(unsigned seed, int count, double size, const Vec3& at) {
  Random random(seed);
  std::vector<testing::Tetrahedron> all;
  for (int n = 0; n < count; ++n) {
    const Vec3 middle = at + random.in_cube(size);
    const auto corner = [&] { return middle + random.in_cube(size); };
    all.push_back({corner(), corner(), corner(), corner()});
  }
  return all;
}

struct Totals {
  Sides anywhere, beside;
};

Totals ask(const SidesOfSamples& sides, unsigned seed, std::int64_t samples) {
  Random random(seed);
  const Box box = bounds(sides.mesh());
  Totals all;
  for (std::int64_t asked = 0; asked < samples; asked += 1024) {
    all.anywhere += sides.compare(testing::anywhere(box, random));
    all.beside += sides.compare(testing::ulps_about(testing::near_surface(sides.mesh(), random)));
  }
  return all;
}

const std::int64_t kAsked = testing::from_environment("STANDOFF_CHECK_SIGNS", 0);

// Another one for each mesh.
unsigned next_seed() {
  static auto seed = static_cast<unsigned>(testing::from_environment("STANDOFF_CHECK_SEED", 1));
  return seed++;
}

void print(const char* place, const Sides& sides) {
  const auto count = [](std::int64_t n) { return static_cast<long long>(n); };
  std::printf("  %s: %lld inside, %lld outside, %lld wrong; %lld on the surface\n", place, count(sides.inside),
              count(sides.outside), count(sides.wrong), count(sides.on_surface));
}

void expect_right(const std::string& name, const Mesh& mesh, std::int64_t few,
                  const SignOptions& options = testing::kAsItIs) {
  const unsigned seed = next_seed();
  const Totals all = ask(SidesOfSamples(mesh, options), seed, kAsked > 0 ? kAsked : few);
  EXPECT_EQ(all.anywhere.wrong, 0) << name << ", seed " << seed;
  EXPECT_EQ(all.beside.wrong, 0) << name << ", seed " << seed;
  EXPECT_GT(all.beside.inside, 0) << name;
  EXPECT_GT(all.beside.outside, 0) << name;
  if (kAsked == 0) return;
  std::printf("%s, %zu triangles, seed %u\n", name.c_str(), mesh.triangles.size(), seed);
  print("random", all.anywhere);
  print("beside the surface", all.beside);
}

TEST(ExactSign, IntersectingSolidsOfAllSizes) {
  for (const double size : {1.0, 1e-30, 1e30, 1e-7})
    for (const double far : {0.0, 1e6}) {
      const Mesh mesh = testing::mesh_of(tetrahedra(next_seed(), 12, size, Vec3{1, -0.7, 0.3} * (far * size)));
      const std::string name = "solids of " + exact_text(size) + " at " + exact_text(far * size);
      expect_right(name, mesh, 10'000);
      expect_right(name + ", nonzero", mesh, 4'000,
                   {.method = SignMethod::winding, .rule = WindingRule::nonzero, .as_oriented = true});
      expect_right(name + ", parity", mesh, 4'000, {.method = SignMethod::parity});
    }
}

TEST(ExactSign, SolidsWithManyCornersInOnePlane) {
  Random random(next_seed());
  expect_right("integers", testing::mesh_of(testing::integer_tetrahedra(random, 40, 4)), 40'000);
  expect_right("flat", testing::mesh_of(testing::integer_tetrahedra(random, 40, 1)), 20'000);
}

TEST(ExactSign, ClosedScenes) {
  if (kAsked == 0) {
    for (const char* name :
         {"box", "sphere", "fly", "catapult", "bender", "process", "far_away", "tiny", "nested", "duplicate"})
      expect_right(name, scenes::make(name, 2000), 5'000);
    return;
  }
  for (const scenes::Scene& scene : scenes::all())
    if (const Mesh mesh = scenes::make(scene.name); is_closed(mesh).oriented) expect_right(scene.name, mesh, 0);
}

TEST(ExactSign, Bunny) {
  const std::filesystem::path path = "/usr/share/glmark2/models/bunny.obj";
  if (kAsked == 0 || !std::filesystem::exists(path)) GTEST_SKIP() << "in long checks, where glmark2's models are";
  expect_right("bunny", read_mesh(path).mesh, 0);
}

}  // namespace
}  // namespace standoff
