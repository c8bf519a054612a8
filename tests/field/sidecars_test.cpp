// SPDX-License-Identifier: Apache-2.0
// Sidecars against all triangles in double precision and against closed forms: degenerate triangles, samples on the
// surface, signs, meshes far away, threads and instruction sets.
// labels: memory threads
#include "standoff/sidecars.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "standoff/compute.h"
#include "standoff/points.h"
#include "tests/sign/shapes.h"
#include "tests/support/expect_error.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

constexpr std::array kAll{SidecarKind::closest_point, SidecarKind::barycentric, SidecarKind::feature,
                          SidecarKind::gradient};

ComputeOptions with_nearest(SignMethod sign = SignMethod::none) {
  return {.sign = {.method = sign}, .execution = {.backend = Backend::cpu}, .nearest = true};
}

// The sidecars of a sample.
struct Beside {
  Vec3 at, closest, gradient;
  std::array<double, 3> weights;
  Feature feature;
  float value;
  std::uint32_t nearest;
};

Vec3 three(const Sidecar& sidecar, std::size_t n) {
  const float* v = std::get<std::vector<float>>(sidecar.values).data() + 3 * n;
  return {v[0], v[1], v[2]};
}

template <class Use>
void for_each_sample(const DistanceField& field, const std::vector<Sidecar>& beside, const Use& use) {
  const Size3 size = field.grid().size;
  for (const DistanceField::Tile& tile : field.tiles()) {
    const std::int32_t slot = field.slots()[static_cast<std::size_t>(tile.index)];
    for (int n = 0; n < DistanceField::kTileSamples; ++n) {
      const std::int64_t i = 8 * tile.at.x + n % 8, j = 8 * tile.at.y + n / 8 % 8, k = 8 * tile.at.z + n / 64;
      const auto place = static_cast<std::size_t>(512 * slot + n);
      const Vec3 weights = three(beside[1], place);
      const Beside one{field.grid().position(i, j, k),
                       three(beside[0], place),
                       three(beside[3], place),
                       {weights.x, weights.y, weights.z},
                       static_cast<Feature>(std::get<std::vector<std::uint8_t>>(beside[2].values)[place]),
                       tile.values[static_cast<std::size_t>(n)],
                       tile.nearest[static_cast<std::size_t>(n)]};
      if (i < size.x && j < size.y && k < size.z && one.nearest != kNoTriangle)
        use(one);
      else
        EXPECT_TRUE(one.closest == Vec3{} && one.gradient == Vec3{} && weights == Vec3{} &&
                    one.feature == Feature::face);
    }
  }
}

Vec3 weighted(MeshView mesh, const Beside& s) {
  const auto t = mesh.corners(s.nearest);
  return t[0] * s.weights[0] + t[1] * s.weights[1] + t[2] * s.weights[2];
}

// Checks which weights are zero.
void expect_feature(const Beside& s) {
  const auto n = static_cast<std::size_t>(s.feature);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(s.weights[k] >= 0 && s.weights[k] <= 1);
    const bool is_zero = n > 3 ? k != n - 4 : n > 0 && k == (n + 1) % 3;
    EXPECT_EQ(s.weights[k] == 0, is_zero) << n;
  }
  EXPECT_NEAR(s.weights[0] + s.weights[1] + s.weights[2], 1, 3e-7);
}

// Checks everything that must hold for any mesh. `far`: the magnitude of the coordinates.
std::int64_t expect_right(const Mesh& mesh, const Grid& grid, double thickness, double far) {
  const DistanceField field = compute(mesh, grid, thickness, with_nearest()).field;
  const std::vector<Sidecar> beside = sidecars(mesh, field, kAll);
  const double spacing = grid.max_spacing(), rounding = 2e-7 * far;
  std::int64_t samples = 0;
  for_each_sample(field, beside, [&](const Beside& s) {
    ++samples;
    const double allowed = 1e-6 * (s.value + 16 * spacing) + rounding;
    EXPECT_NEAR(length(s.closest - s.at), s.value, allowed);
    EXPECT_LE(length(weighted(mesh, s) - s.closest), allowed);
    expect_feature(s);
    EXPECT_NEAR(length(s.gradient), 1, 1e-6);
    if (s.value > 0.01 * spacing + 100 * rounding) {
      EXPECT_LE(length(s.at - s.closest - s.gradient * double(s.value)), 2 * allowed);
    }
  });
  return samples;
}

TEST(Sidecars, OfRandomTriangles) {
  const Mesh soup = testing::random_soup(1, 300, 2, 0.8);
  EXPECT_GT(expect_right(soup, {{40, 33, 29}, {-2, -1.8, -1.5}, {0.1, 0.11, 0.12}}, 0.35, 3), 10000);
  EXPECT_GT(expect_right(soup, {{17, 9, 12}, {-3, -3, -3}, {0.4, 0.7, 0.5}}, kFullField, 5), 1000);
  EXPECT_EQ(expect_right(soup, {{1, 1, 1}, {0.1, 0.2, 0.3}}, kFullField, 3), 1);
}

TEST(Sidecars, OfDegenerateTriangles) {
  EXPECT_GT(expect_right(testing::nasty_soup(3, 200, 2), {{30, 30, 30}, {-2, -2, -2}, {0.14, 0.14, 0.14}}, 0.5, 3),
            3000);
}

// The nearest triangle comes from the field; point, weights and distance must equal the exact ones of closest_points().
void expect_as_closest_points(const Mesh& mesh, const Grid& grid) {
  const DistanceField field = compute(mesh, grid, 0.3, with_nearest()).field;
  std::int64_t same = 0, all = 0;
  for_each_sample(field, sidecars(mesh, field, kAll), [&](const Beside& s) {
    const Vec3 points[1] = {s.at};
    const ClosestPoint exact = closest_points(mesh, points, {.execution = {.threads = 1}})[0];
    ++all;
    if (exact.triangle != s.nearest) return;  // both are equally near within rounding
    ++same;
    EXPECT_LE(length(exact.point - s.closest), 2e-7);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(exact.barycentric[k], s.weights[k], 1e-6);
  });
  EXPECT_GT(same, all / 2);
  EXPECT_GT(all, 1000);
}

// Triangles that are nearest to few samples of a tile, and to many.
TEST(Sidecars, AsClosestPoints) {
  expect_as_closest_points(testing::torus(), fit_resolution(bounds(testing::torus()), 24, 0.3));
  const Mesh cone{{{0.1, 0.2, 1.3}, {-1, -0.7, 0}, {1.2, -0.9, 0.1}, {0.3, 1.1, -0.1}},
                  {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}};
  expect_as_closest_points(cone, fit_resolution(bounds(cone), 60, 0.3));
}

TEST(Sidecars, FarAway) {
  const Vec3 shift{0x1p30, -0x1p31, 0x1p29};
  Mesh mesh = testing::torus();
  const Grid grid{{40, 40, 20}, {-0.5, -1.5, -1.5}, {0x1p-4, 0x1p-4, 0x1p-3}};
  for (Vec3& v : mesh.vertices) v = (v + shift) - shift;  // round as at the shifted place
  Mesh far = mesh;
  for (Vec3& v : far.vertices) v = v + shift;
  ComputeOptions in_order = with_nearest();
  in_order.execution.threads = 1;  // so that tiles have the same slots
  const DistanceField here = compute(mesh, grid, 0.25, in_order).field,
                      there = compute(far, {grid.size, grid.origin + shift, grid.spacing}, 0.25, in_order).field;
  const auto near_sidecars = sidecars(mesh, here, kAll), far_sidecars = sidecars(far, there, kAll);
  for (const std::size_t n : {1, 2, 3}) EXPECT_EQ(near_sidecars[n].values, far_sidecars[n].values);
}

// A box whose faces, edges and corners go through samples.
TEST(Sidecars, OnTheSurface) {
  const Mesh box = testing::box({0, 0, 0}, {4, 4, 4});
  const Grid grid{{9, 9, 9}, {-2, -2, -2}};
  for (const bool turned : {false, true})
    for (const SignMethod method : {SignMethod::winding, SignMethod::normal, SignMethod::none}) {
      const Mesh mesh = turned ? testing::reversed(box) : box;
      const DistanceField field = compute(mesh, grid, kFullField, with_nearest(method)).field;
      std::int64_t on_surface = 0, vertices = 0;
      for_each_sample(field, sidecars(mesh, field, kAll), [&](const Beside& s) {
        EXPECT_NEAR(length(s.gradient), 1, 1e-6);
        const Vec3 middle = s.at - Vec3{2, 2, 2};
        if (std::abs(s.value) > 1e-5) {
          // The gradient points out of the box, or, without a sign, away from its surface.
          EXPECT_TRUE(method == SignMethod::none || middle == Vec3{} || dot(s.gradient, middle) > 0);
          EXPECT_LE(length(s.at - s.closest - s.gradient * double(s.value)), 1e-6);
          return;
        }
        ++on_surface;
        vertices += s.feature >= Feature::vertex0;
        EXPECT_EQ(s.closest, s.at);
        const auto t = MeshView(box).corners(s.nearest);
        const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
        const double along = dot(normal * (1 / length(normal)), s.gradient);
        // The gradient has the orientation of the sign; without one, that of the mesh.
        EXPECT_NEAR(along, method == SignMethod::none && turned ? -1 : 1, 1e-6);
      });
      EXPECT_EQ(on_surface, 5 * 5 * 5 - 3 * 3 * 3);
      EXPECT_GE(vertices, 8);
    }
}

TEST(Sidecars, GradientOfSignedFields) {
  const Mesh mesh = testing::sphere(16);
  const Grid grid = fit_resolution(bounds(mesh), 30, 0.3);
  for (const bool invert : {false, true}) {
    ComputeOptions options = with_nearest(SignMethod::winding);
    options.sign.invert = invert;
    const DistanceField field = compute(mesh, grid, 0.3, options).field;
    std::int64_t inside = 0;
    for_each_sample(field, sidecars(mesh, field, kAll), [&](const Beside& s) {
      inside += s.value < 0;
      EXPECT_GT(dot(s.gradient, s.at) * (invert ? -1 : 1), 0);
      EXPECT_LE(length(s.at - s.closest - s.gradient * double(s.value)), 1e-5);
    });
    EXPECT_GT(inside, 1000);
  }
  // The values of a shell grow away from the mesh on both sides.
  ComputeOptions options = with_nearest(SignMethod::shell);
  options.sign.shell = 0.2;
  const DistanceField shell = compute(mesh, grid, 0.3, options).field;
  for_each_sample(shell, sidecars(mesh, shell, kAll), [&](const Beside& s) {
    EXPECT_LE(length(s.at - s.closest - s.gradient * (double(s.value) + 0.1)), 1e-5);
  });
}

// The features on edges and vertices of a triangle, in both directions of each edge.
TEST(Sidecars, FeaturesOfOneTriangle) {
  const Mesh mesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}};
  const Grid grid{{9, 9, 1}, {-2, -2, 1}};
  const DistanceField field = compute(mesh, grid, kFullField, with_nearest()).field;
  for_each_sample(field, sidecars(mesh, field, kAll), [&](const Beside& s) {
    const double x = s.at.x, y = s.at.y;
    const Feature known = x <= 0 && y <= 0 ? Feature::vertex0
                          : y <= 0         ? (x >= 4 ? Feature::vertex1 : Feature::edge0)
                          : x <= 0         ? (y >= 4 ? Feature::vertex2 : Feature::edge2)
                          : x - y >= 4     ? Feature::vertex1
                          : y - x >= 4     ? Feature::vertex2
                          : x + y >= 4     ? Feature::edge1
                                           : Feature::face;
    EXPECT_EQ(s.feature, known) << x << ' ' << y;
  });
}

TEST(Sidecars, SameBitsForAnyThreadsSetsAndLayouts) {
  const Mesh mesh = testing::nasty_soup(5, 300, 2);
  const Grid grid{{30, 30, 30}, {-2, -2, -2}, {0.14, 0.14, 0.14}};
  const DistanceField field = compute(mesh, grid, 0.5, with_nearest()).field;
  const auto one = sidecars(mesh, field, kAll, {.execution = {.threads = 1}});
  const auto expect_same = [&](const std::vector<Sidecar>& other) {
    for (std::size_t n = 0; n < one.size(); ++n) EXPECT_EQ(one[n].values, other[n].values) << one[n].name;
  };
  expect_same(sidecars(mesh, field, kAll, {.execution = {.threads = 3}}));
  for (const Simd set : {Simd::portable, Simd::avx2, Simd::avx512}) {
    try {
      expect_same(sidecars(mesh, field, kAll, {.execution = {.simd = set}}));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);  // the processor lacks the set
    }
  }
  std::vector<std::int64_t> indices;
  for (const Triangle& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  const MeshView view{mesh.vertices, {indices.data(), mesh.triangles.size()}};
  expect_same(sidecars(view, field, kAll));
  // Reuse memory that holds other sidecars.
  std::vector<Sidecar> into = sidecars(mesh, compute(mesh, grid, 0.7, with_nearest()).field, kAll);
  sidecars_into(mesh, field, kAll, into);
  expect_same(into);
  // Ask for one kind at a time.
  for (std::size_t n = 0; n < kAll.size(); ++n)
    EXPECT_EQ(sidecars(mesh, field, std::array{kAll[n]})[0].values, one[n].values);
}

TEST(Sidecars, Errors) {
  const Mesh mesh = testing::box();
  const Grid grid{{9, 9, 9}, {-1, -1, -1}, {0.4, 0.4, 0.4}};
  const DistanceField field = compute(mesh, grid, 1, with_nearest()).field;
  const Mesh few{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const auto fails = [&](ErrorCode code, const std::string& words, const Mesh& of, const DistanceField& with,
                         std::span<const SidecarKind> kinds, const ProgressCallback& progress = {}) {
    expect_error([&] { sidecars(of, with, kinds, {.progress = progress}); }, code, words);
  };
  fails(ErrorCode::usage, "no nearest triangles", mesh, DistanceField(grid, 1), kAll);
  fails(ErrorCode::usage, "no such kind", mesh, field, std::array{static_cast<SidecarKind>(9)});
  fails(ErrorCode::usage, "twice", mesh, field, std::array{SidecarKind::feature, SidecarKind::feature});
  fails(ErrorCode::input, "does not have, of 1", few, field, kAll);
  fails(ErrorCode::limit, "2^100 spacings", testing::moved(mesh, {0, 0, 0}, 1e40), field, kAll);
  fails(ErrorCode::interrupted, "cancelled", mesh, field, kAll, [](const Progress&) { return false; });
}

// What sidecars will take can be told before the work.
TEST(Sidecars, MemoryIsEstimated) {
  const Mesh mesh = testing::sphere(16);
  const Grid grid = fit_resolution(bounds(mesh), 60, 0.1);
  const ComputeOptions options = with_nearest();
  const MemoryEstimate found = estimate(mesh, grid, 0.1, options);
  const DistanceField field = compute(mesh, grid, 0.1, options).field;
  std::int64_t bytes = 0, taken = 0;
  for (const SidecarKind kind : kAll) bytes += bytes_per_sample(kind);
  EXPECT_EQ(bytes, 37);
  for (const Sidecar& sidecar : sidecars(mesh, field, kAll))
    taken += std::visit([](const auto& values) { return static_cast<std::int64_t>(std::span(values).size_bytes()); },
                        sidecar.values);
  EXPECT_EQ(taken, bytes * 512 * field.stored_tiles());
  EXPECT_GE(found.stored_samples, 512 * field.stored_tiles());
  EXPECT_LE(found.stored_samples, 4 * 512 * field.stored_tiles()) << "the bound is good for nothing";
  EXPECT_GE(found.whole, field.memory_bytes());
}

}  // namespace
}  // namespace standoff
