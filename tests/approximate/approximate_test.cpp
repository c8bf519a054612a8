// SPDX-License-Identifier: Apache-2.0
// labels: threads
// The algorithms of others (docs/methods.md): their documented bounds on meshes of every kind, cases where they are
// wrong, and the same bits on the emulated GPU.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gpu/emulation/block.h"
#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "standoff/testing/emulation.h"
#include "standoff/verify.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {
namespace {

constexpr Method kSpreading[] = {Method::propagate, Method::jumpflood, Method::jumpflood_1};

ComputeResult by(Method method, MeshView mesh, const Grid& grid, double thickness, Backend backend = Backend::cpu,
                 int threads = 2) {
  ComputeOptions options{.method = method,
                         .sign = {SignMethod::none},
                         .execution = {.threads = threads, .backend = backend},
                         .nearest = true};
  return compute(mesh, grid, thickness, options);
}

// The factor a of the bound a (d + h) + h.
double factor_of(Method method, const Grid& grid) {
  const bool cubic = grid.spacing.x == grid.spacing.y && grid.spacing.y == grid.spacing.z;
  return method == Method::propagate && cubic ? 1.1281 : std::sqrt(3.0);
}

struct Errors {
  std::int64_t too_large = 0;  // beyond rounding
  double largest = 0;          // in spacings
};

// Each value is the distance from the stored triangle, and within the documented bound.
Errors expect_within_bounds(Method method, MeshView mesh, const Grid& grid, double thickness) {
  const DistanceField field = by(method, mesh, grid, thickness).field;
  const double diagonal = length(grid.spacing), factor = factor_of(method, grid);
  Errors errors;
  for_each_sample(grid, [&](auto i, auto j, auto k) {
    const Vec3 p = grid.position(i, j, k);
    const double exact = reference_distance(mesh, p), allowed = allowed_error(grid, exact),
                 value = field.value(i, j, k);
    const std::uint32_t nearest = field.nearest(i, j, k);
    EXPECT_GE(value, std::min(exact, thickness) - allowed);
    EXPECT_LE(value, std::min(factor * (exact + diagonal) + diagonal, thickness) + allowed);
    if (nearest != kNoTriangle) {
      EXPECT_NEAR(value, reference_distance(mesh, nearest, p), 2 * allowed);
    } else {
      EXPECT_EQ(value, static_cast<float>(thickness));
    }
    errors.too_large += value > std::min(exact, thickness) + allowed;
    errors.largest = std::max(errors.largest, (value - std::min(exact, thickness)) / grid.max_spacing());
    if (exact <= diagonal - allowed) {
      EXPECT_NEAR(value, std::min(exact, thickness), allowed) << "a seed is exact";
    }
  });
  return errors;
}

TEST(Spreading, StayWithinTheirBoundsOnAnyMesh) {
  const Grid cubic{{25, 19, 22}, {-6, -5, -5.5}, {0.5, 0.5, 0.5}}, unequal{{17, 24, 13}, {-6, -5, -5}, {0.7, 0.4, 0.8}};
  const Mesh meshes[] = {random_soup(1, 40, 4, 1.5), nasty_soup(2, 80, 5), random_soup(3, 6, 4, 8)};
  for (const Method method : kSpreading)
    for (const Mesh& mesh : meshes)
      for (const Grid& grid : {cubic, unequal})
        for (const double thickness : {0.3, 2.0, kInfinity}) {
          SCOPED_TRACE(std::string(find_info(method)->name) + ", thickness " + std::to_string(thickness));
          expect_within_bounds(method, mesh, grid, thickness);
        }
}

// Inside a sphere of triangles smaller than a spacing: of the triangles near a sample's nearest one, many are nearest
// to no sample at the surface or on the way, so they are not handed on. These methods are not exact, and must not be a
// default.
struct FineSphere {
  Mesh mesh = scenes::make("sphere", 3000);
  Grid grid = fit_resolution(bounds(mesh), 16, {.least_samples = 1});
};

TEST(Spreading, AreWrongSomewhere) {
  const auto [mesh, grid] = FineSphere();
  std::int64_t wrong[3];
  for (int n = 0; n < 3; ++n) {
    const Errors errors = expect_within_bounds(kSpreading[n], mesh, grid, kInfinity);
    wrong[n] = errors.too_large;
    EXPECT_GT(wrong[n], 0) << find_info(kSpreading[n])->name;
    EXPECT_LT(errors.largest, 1) << find_info(kSpreading[n])->name;
  }
  EXPECT_LE(wrong[2], wrong[1]) << "a further pass mends";
}

TEST(Spreading, VerifyCountsWhatIsWrong) {
  const auto [mesh, grid] = FineSphere();
  const VerifyResult found = verify(by(Method::jumpflood, mesh, grid, kInfinity).field, mesh, {.samples = 64'000});
  EXPECT_GT(found.samples_wrong, 0);
  EXPECT_FALSE(found.ok());
  EXPECT_TRUE(verify(by(Method::tiles, mesh, grid, kInfinity).field, mesh, {.samples = 64'000}).ok());
}

TEST(Spreading, GiveTheSameBitsForAnyThreadsAndOnTheEmulatedGpu) {
  using emulation::Order;
  Mesh mesh = nasty_soup(5, 60, 5);
  const std::size_t originals = mesh.triangles.size();
  for (std::size_t t = 0; t < originals; ++t) mesh.triangles.push_back(mesh.triangles[t]);  // ties
  const Grid grids[] = {{{19, 14, 11}, {-5, -4, -3}, {0.5, 0.6, 0.6}}, {{1, 9, 30}, {0, -3, -7}, {0.5, 0.5, 0.5}}};
  for (const Method method : kSpreading)
    for (const Grid& grid : grids)
      for (const double thickness : {0.9, kInfinity}) {
        SCOPED_TRACE(std::string(find_info(method)->name) + ", thickness " + std::to_string(thickness));
        const ComputeResult one = by(method, mesh, grid, thickness, Backend::cpu, 1);
        expect_same_bits(one.field, by(method, mesh, grid, thickness, Backend::cpu, 5).field);
        for (const Order order : {Order::forward, Order::reverse, Order::random}) {
          const emulation::OrderScope scope(order, 7);
          const ComputeResult gpu = by(method, mesh, grid, thickness, kEmulated);
          expect_same_bits(one.field, gpu.field);
          EXPECT_EQ(one.report.samples_band, gpu.report.samples_band);
          EXPECT_EQ(one.report.samples_examined, gpu.report.samples_examined);
        }
        for (const std::uint32_t nearest : all_nearest(one.field))
          ASSERT_TRUE(nearest == kNoTriangle || nearest < originals) << "a tie went to the later triangle";
      }
}

TEST(Spreading, FarFromTheOriginAndAtAnyScale) {
  const Vec3 far{1e6, -2e6, 3e6};
  for (const Method method : kSpreading) {
    expect_within_bounds(method, random_soup(6, 30, 4, 1, far), {{15, 15, 15}, far - Vec3{5, 5, 5}, {0.7, 0.7, 0.7}},
                         kInfinity);
    for (const double scale : {1e-20, 1e15}) {
      Mesh mesh = random_soup(7, 30, 4, 1);
      for (Vec3& v : mesh.vertices) v = v * scale;
      expect_within_bounds(method, mesh, {{15, 15, 15}, Vec3{-5, -5, -5} * scale, Vec3{0.7, 0.7, 0.7} * scale},
                           2 * scale);
    }
  }
}

TEST(Spreading, OneTriangleThatCoversEverything) {
  Mesh mesh;
  add_triangle(mesh, {-9e5, -1e6, -8e5}, {1.1e6, -9e5, 7e5}, {-2e5, 1.9e6, 1e5});  // its centre is the origin
  for (const Method method : kSpreading) {
    const Errors errors = expect_within_bounds(method, mesh, {{12, 12, 12}, {-3, -3, -3}, {0.5, 0.5, 0.5}}, kInfinity);
    EXPECT_EQ(errors.too_large, 0);
  }
}

TEST(Spreading, MeshBesideTheGridIsAnError) {
  const Mesh mesh = random_soup(8, 10, 1, 1, {100, 0, 0});
  const Grid grid{{8, 8, 8}, {-1, -1, -1}, {0.25, 0.25, 0.25}};
  for (const Method method : kSpreading)
    for (const Backend backend : {Backend::cpu, kEmulated})
      for (const double thickness : {1.0, kInfinity})
        expect_error([&] { by(method, mesh, grid, thickness, backend); }, ErrorCode::input, "nothing to begin with");
}

// A front of a sweep has few rows if the grid is long along one axis: all of them would take minutes here.
TEST(Spreading, LongGridsTakeNoTime) {
  const Mesh mesh = random_soup(12, 10, 1, 1);
  for (const Size3 size : {Size3{2, 2, 20'000}, Size3{2, 20'000, 2}, Size3{20'000, 2, 2}})
    EXPECT_EQ(by(Method::propagate, mesh, {size, {-0.5, -0.5, -0.5}, {1, 1, 1}}, kInfinity).report.samples_band,
              80'000);
}

TEST(Spreading, CanBeCancelledWhileItSeeks) {
  const Mesh mesh = random_soup(13, 3000, 5, 10);
  const Grid grid{{40, 40, 40}, {-5, -5, -5}, {0.25, 0.25, 0.25}};
  for (const std::string stage : {"seeds", "distances"}) {
    ComputeOptions options{.method = Method::jumpflood, .execution = {.backend = Backend::cpu}};
    options.progress = [&](const Progress& now) { return std::string(now.stage) != stage; };
    expect_error([&] { compute(mesh, grid, kInfinity, options); }, ErrorCode::interrupted, "cancelled");
  }
}

// Fuhrmann: exact over faces, and between the exact distance and the thickness elsewhere.
TEST(Fuhrmann, IsExactOverFacesAndNeverTooSmall) {
  const Mesh mesh = random_soup(9, 30, 4, 2);
  const Grid grid{{25, 25, 25}, {-6, -6, -6}, {0.5, 0.5, 0.5}};
  const double thickness = 1.5;
  const DistanceField field = by(Method::fuhrmann, mesh, grid, thickness).field;
  std::int64_t over_faces = 0, too_large = 0;
  for_each_sample(grid, [&](auto i, auto j, auto k) {
    const Vec3 p = grid.position(i, j, k);
    const double exact = std::min(reference_distance(mesh, p), thickness), allowed = 4e-5, value = field.value(i, j, k);
    EXPECT_GE(value, exact - allowed);
    EXPECT_LE(value, static_cast<float>(thickness));
    too_large += value > exact + allowed;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [a, b, c] = MeshView(mesh).corners(t);
      const Vec3 n = cross(b - a, c - a);
      const double height = std::abs(dot(n, p - a)) / length(n);
      const bool over =
          dot(n, cross(b - a, p - a)) > 0 && dot(n, cross(c - b, p - b)) > 0 && dot(n, cross(a - c, p - c)) > 0;
      if (!over || height > exact + 1e-9 || height >= thickness) continue;
      ++over_faces;
      EXPECT_NEAR(value, exact, allowed) << i << ' ' << j << ' ' << k;
    }
  });
  EXPECT_GT(over_faces, 100);
  EXPECT_GT(too_large, 0) << "samples beside the prisms";
}

TEST(Fuhrmann, LeavesGapsBesideSharpEdges) {
  // Two large triangles that meet at a right angle: the sample in front of the edge lies in no prism.
  Mesh mesh;
  add_triangle(mesh, {-9, 0, 0}, {0, 0, -9}, {0, 0, 9});
  add_triangle(mesh, {0, -9, 0}, {0, 0, 9}, {0, 0, -9});
  const Grid grid{{1, 1, 1}, {0.5, 0.5, 0}, {1, 1, 1}};
  EXPECT_EQ(by(Method::fuhrmann, mesh, grid, 1).field.value(0, 0, 0), 1);
  EXPECT_NEAR(by(Method::tiles, mesh, grid, 1).field.value(0, 0, 0), std::sqrt(0.5), 1e-6);
}

// The sign that comes with the method, beside an exact one: wrong near edges, the more so the larger the triangles are.
TEST(Fuhrmann, PlanesGiveWrongSignsBesideEdges) {
  std::int64_t wrong[2];
  for (const int fine : {0, 1}) {
    Mesh mesh;  // a spindle: its tips are sharper than a right angle
    const int sides = fine ? 48 : 3;
    for (int n = 0; n < sides; ++n) {
      const auto at = [&](int k) {
        const double angle = 2 * 3.14159265358979 * (k % sides) / sides;
        return Vec3{std::cos(angle), std::sin(angle), 0};
      };
      add_triangle(mesh, at(n), at(n + 1), {0, 0, 3});
      add_triangle(mesh, at(n + 1), at(n), {0, 0, -3});
    }
    const Grid grid{{31, 31, 61}, {-2.5, -2.5, -5}, {1 / 6., 1 / 6., 1 / 6.}};
    ComputeOptions options{.method = Method::fuhrmann, .sign = {SignMethod::facet}};
    const DistanceField by_plane = compute(mesh, grid, 8, options).field;
    const DistanceField exact = compute(mesh, grid, 8, {.sign = {SignMethod::winding}}).field;
    const VerifyResult found = verify(by_plane, mesh, {.samples = grid.sample_count()});
    wrong[fine] = 0;
    for_each_sample(grid, [&](auto i, auto j, auto k) {
      wrong[fine] += exact.value(i, j, k) != 0 && by_plane.value(i, j, k) < 0 != exact.value(i, j, k) < 0;
    });
    EXPECT_LE(found.sign.wrong, wrong[fine]);
    EXPECT_GE(found.sign.wrong + found.sign.unknown, wrong[fine]) << "where the rounding of a distance hides no sign";
  }
  EXPECT_GT(wrong[1], 0);
  EXPECT_GT(wrong[0], wrong[1]) << "larger triangles";
}

// Samples in the plane of a face are on neither side: none may hand its side on to the inside of a cube.
TEST(Facet, LeavesTheInsideInside) {
  const Mesh box = scenes::make("box");
  const Grid grid = fit_spacing(bounds(box), {0.125, 0.125, 0.125}, Padding{.least_samples = 2});
  ComputeOptions options{.sign = {SignMethod::facet}};
  const VerifyResult found = verify(compute(box, grid, 0.9 * 0.125, options).field, box, {.samples = 1'000'000});
  EXPECT_GT(found.sign.negative, 0);
  EXPECT_EQ(found.sign.wrong, 0);
}

TEST(Fuhrmann, TakesDegenerateTrianglesAndAnyThreads) {
  const Mesh mesh = nasty_soup(10, 80, 5);
  const Grid grid{{22, 22, 22}, {-5, -5, -5}, {0.5, 0.5, 0.5}};
  expect_same_bits(by(Method::fuhrmann, mesh, grid, 1, Backend::cpu, 1).field,
                   by(Method::fuhrmann, mesh, grid, 1, Backend::cpu, 5).field);
}

TEST(Fuhrmann, RefusesWhatItCannotDo) {
  const Mesh mesh = random_soup(11, 10, 1, 1);
  const Grid grid{{8, 8, 8}, {-1, -1, -1}, {0.25, 0.25, 0.25}};
  expect_error([&] { by(Method::fuhrmann, mesh, grid, kInfinity); }, ErrorCode::usage, "fuhrmann has no full fields");
  expect_error([&] { by(Method::fuhrmann, mesh, grid, 1, kEmulated); }, ErrorCode::usage,
               "fuhrmann runs on the CPU alone");
  expect_error([&] { by(Method::fuhrmann, mesh, grid, 1, Backend::cuda); }, ErrorCode::usage,
               "fuhrmann runs on the CPU alone");
}

}  // namespace
}  // namespace standoff::testing
