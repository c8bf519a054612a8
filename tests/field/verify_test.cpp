// SPDX-License-Identifier: Apache-2.0
// labels: memory threads

#include "standoff/verify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "field/reference.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "tests/support/closest_of_all.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using testing::brute_distance;
using testing::random_soup;

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
const Grid kVerifyGrid{{20, 17, 23}, {-1.5, -1.25, -1.75}, {0.15, 0.16, 0.17}};

// The field by definition; `spoil` may change a value.
template <class Spoil>
DistanceField field_of(const Mesh& mesh, double thickness, Spoil spoil, bool with_nearest = false) {
  std::vector<float> values;
  std::vector<std::uint32_t> nearest;
  for (std::int64_t k = 0; k < kVerifyGrid.size.z; ++k)
    for (std::int64_t j = 0; j < kVerifyGrid.size.y; ++j)
      for (std::int64_t i = 0; i < kVerifyGrid.size.x; ++i) {
        const Vec3 p = kVerifyGrid.position(i, j, k);
        const double distance = brute_distance(mesh, p);
        values.push_back(static_cast<float>(std::min(distance, thickness)));
        nearest.push_back(kNoTriangle);
        if (with_nearest && distance <= thickness)
          for (std::size_t t = mesh.triangles.size(); t-- > 0;)
            if (testing::triangle_distance(mesh, t, p) == distance) nearest.back() = static_cast<std::uint32_t>(t);
        spoil(i, j, k, values.back(), nearest.back());
      }
  if (!with_nearest) nearest.clear();
  return DistanceField::from_dense(kVerifyGrid, thickness, values, nearest);
}
DistanceField field_of(const Mesh& mesh, double thickness) {
  return field_of(mesh, thickness, [](auto...) {});
}

VerifyOptions every_sample() { return {.samples = kVerifyGrid.sample_count()}; }

TEST(TriangleGroups, SameAsBruteForce) {
  testing::Random random(3);
  // Take more triangles than a group holds, a group that is not full, and a mesh without extent on one axis.
  for (const int triangles : {1, 31, 32, 33, 500}) {
    Mesh mesh = random_soup(static_cast<unsigned>(triangles), triangles, 1, 0.2);
    if (triangles == 33)
      for (Vec3& v : mesh.vertices) v.z = 0.25;
    const TriangleGroups groups(mesh);
    EXPECT_EQ(groups.triangle_count(), static_cast<std::size_t>(triangles));
    for (int n = 0; n < 300; ++n) {
      const Vec3 p = random.in_cube(n < 100 ? 10 : 1);
      EXPECT_EQ(groups.distance(p), brute_distance(mesh, p));
    }
  }
}

TEST(TriangleGroups, HugeCoordinates) {
  Mesh mesh;
  testing::add_triangle(mesh, {-1e308, 0, 0}, {1e308, 1, 0}, {0, 2, 0});
  testing::add_triangle(mesh, {0, 0, 1}, {1, 0, 1}, {0, 1, 1});
  EXPECT_NO_THROW(TriangleGroups{mesh});
}

TEST(Verify, TrueFieldsPass) {
  const Mesh mesh = random_soup(1, 40, 1, 0.4);
  for (const double thickness : {0.2, kUnlimited}) {
    const VerifyResult found = verify(field_of(mesh, thickness), mesh, every_sample());
    EXPECT_TRUE(found.ok());
    EXPECT_EQ(found.samples, kVerifyGrid.sample_count());
    EXPECT_EQ(found.samples_wrong, 0);
    EXPECT_LE(found.worst.error, found.worst.allowed);
    EXPECT_GT(found.samples_band, 0);
    EXPECT_FALSE(found.mesh_differs);
  }
}

TEST(Verify, SamplesAtTheThicknessLieInTheBand) {
  const Mesh plane{{{-1, -1, 7}, {17, -1, 7}, {-1, 17, 7}, {17, 17, 7}}, {{0, 1, 2}, {1, 3, 2}}};
  ComputeOptions options{.sign = {SignMethod::none}};
  const ComputeResult computed = compute(plane, {{16, 16, 16}, {}, {1, 1, 1}}, 1, options);
  EXPECT_EQ(computed.report.samples_band, 3 * 256);
  EXPECT_EQ(verify(computed.field, plane, every_sample()).samples_band, 3 * 256);
}

TEST(Verify, FindsOneWrongSample) {
  const Mesh mesh = random_soup(2, 40, 1, 0.4);
  const auto wrong_by = [&](double factor) {
    const auto field = field_of(mesh, kUnlimited, [&](auto i, auto j, auto k, float& value, auto&) {
      if (i == 5 && j == 6 && k == 7) value = static_cast<float>(value + factor * allowed_error(kVerifyGrid, value));
    });
    return verify(field, mesh, every_sample());
  };
  EXPECT_TRUE(wrong_by(0.8).ok());
  for (const double factor : {1.2, -1.2, 1000.0}) {
    const VerifyResult found = wrong_by(factor);
    EXPECT_FALSE(found.ok());
    EXPECT_EQ(found.samples_wrong, 1);
    EXPECT_EQ(found.worst.i, 5);
    EXPECT_EQ(found.worst.j, 6);
    EXPECT_EQ(found.worst.k, 7);
    EXPECT_EQ(found.worst.position, kVerifyGrid.position(5, 6, 7));
    EXPECT_NEAR(found.worst.error, std::abs(factor) * found.worst.allowed,
                0.1 * std::abs(factor) * found.worst.allowed);
  }
}

void expect_same(const SampleCheck& a, const SampleCheck& b) {
  EXPECT_EQ(std::tie(a.i, a.j, a.k, a.stored, a.expected, a.error, a.allowed),
            std::tie(b.i, b.j, b.k, b.stored, b.expected, b.error, b.allowed));
}

// Some slices at a time the same samples are tested, and the same is found.
TEST(Verify, SlicesAreTheField) {
  const Mesh mesh = random_soup(5, 60, 0.7, 0.4);
  Grid grid{{70, 40, 90}, {-1.5, -1.25, -1.75}, {0.04, 0.06, 0.04}};
  DistanceField field = compute(mesh, grid, 0.2, {.nearest = true}).field;
  std::vector<Size3> tiles;
  for (const DistanceField::Tile& tile : field.tiles()) tiles.push_back(tile.at);
  for (const Size3& at : tiles)
    if (at.z > 4 && at.x % 3 == 0)
      for (float& value : field.edit_tile(at.x, at.y, at.z).first<40>()) value *= -0.9f;
  std::int64_t most = 0;
  const SliceReader read = [&](std::int64_t first, std::int64_t count) {
    most = std::max(most, count);
    const Grid part = grid.window({0, 0, first}, {grid.size.x, grid.size.y, count});
    DistanceField slices(part, field.thickness(), true);
    slices.set_provenance(field.provenance());
    for (const DistanceField::Tile& tile : field.tiles()) {
      const std::int64_t z = tile.at.z - first / 8;
      if (z < 0 || z >= slices.tile_count().z) continue;
      std::ranges::copy(tile.values, slices.store_tile(tile.at.x, tile.at.y, z).begin());
      std::ranges::copy(tile.nearest, slices.store_nearest(tile.at.x, tile.at.y, z).begin());
    }
    return slices;
  };
  for (const std::int64_t samples : {std::int64_t{500}, std::int64_t{20'000}, std::int64_t{1'000'000}}) {
    SCOPED_TRACE(samples);
    const VerifyResult whole = verify(field, mesh, {.samples = samples}),
                       sliced = verify(grid, field.thickness(), read, mesh, {.samples = samples}, 1);
    EXPECT_EQ(most, 32);
    EXPECT_EQ(
        std::tie(whole.samples, whole.samples_band, whole.samples_wrong, whole.nearest_wrong, whole.mesh_differs),
        std::tie(sliced.samples, sliced.samples_band, sliced.samples_wrong, sliced.nearest_wrong, sliced.mesh_differs));
    EXPECT_GT(samples > 500 ? whole.samples_wrong : 1, 0);
    expect_same(whole.largest, sliced.largest);
    expect_same(whole.worst, sliced.worst);
    EXPECT_EQ(whole.sign.checked, sliced.sign.checked);
    EXPECT_EQ(whole.sign.wrong, sliced.sign.wrong);
  }
  const SliceReader others = [&](std::int64_t, std::int64_t) { return DistanceField(grid, 0.2); };
  EXPECT_THROW(verify(grid, 0.2, others, mesh, {}, 1), Error);
  EXPECT_THROW(verify(grid, 0.2, read, mesh, {}, 0), Error);
}

TEST(Verify, NotANumberIsWrong) {
  const Mesh mesh = random_soup(2, 10, 1, 0.4);
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const auto field = field_of(mesh, kUnlimited, [&](auto i, auto j, auto k, float& at, auto&) {
      if (i + j + k == 0) at = value;
    });
    const VerifyResult found = verify(field, mesh, every_sample());
    EXPECT_EQ(found.samples_wrong, 1);
    EXPECT_EQ(found.largest.error, kUnlimited);
    EXPECT_EQ(found.largest.i + found.largest.j + found.largest.k, 0);
  }
}

// A field without its band: no tile is stored, all values are the thickness.
TEST(Verify, EmptyFieldFails) {
  const Mesh mesh = random_soup(4, 40, 1, 0.4);
  const VerifyResult found = verify(DistanceField(kVerifyGrid, 0.3), mesh, every_sample());
  EXPECT_FALSE(found.ok());
  EXPECT_EQ(found.samples_wrong, found.samples_band);
}

TEST(Verify, WrongNearestTriangleIsFound) {
  const Mesh mesh = random_soup(5, 20, 1, 0.4);
  const auto checked = [&](auto spoil) { return verify(field_of(mesh, 0.5, spoil, true), mesh, every_sample()); };
  EXPECT_TRUE(checked([](auto...) {}).ok());
  const auto spoil_one = [](std::uint32_t wrong) {
    return [wrong, done = false](auto, auto, auto, float&, std::uint32_t& nearest) mutable {
      if (done || nearest == kNoTriangle || nearest == wrong) return;
      nearest = wrong;
      done = true;
    };
  };
  for (const std::uint32_t wrong : {0u, 1'000'000u, kNoTriangle}) {
    const VerifyResult found = checked(spoil_one(wrong));
    EXPECT_EQ(found.nearest_wrong, 1) << wrong;
    EXPECT_EQ(found.samples_wrong, 0);
    EXPECT_FALSE(found.ok());
  }
}

// One triangle in a wide grid: random samples alone would hardly meet its band.
// If the provenance does not name the sign, signs are not verified. A negative distance was once taken to be wrong.
TEST(Verify, ChecksTheDistanceOfSignedFields) {
  Mesh mesh;
  testing::add_triangle(mesh, {0.5, 0.5, 0.5}, {1, 0.5, 0.5}, {0.5, 1, 0.5});
  const auto inside = [](auto, auto, auto, float& value, auto&) { value = -value; };
  EXPECT_TRUE(verify(field_of(mesh, 0.5, inside), mesh, every_sample()).ok());
  EXPECT_GT(std::ranges::count(field_of(mesh, 0.5, inside).slots(), DistanceField::kInside), 0);
  const auto wrong = [](auto i, auto, auto, float& value, auto&) { value = i == 14 ? -value - 0.1f : -value; };
  EXPECT_FALSE(verify(field_of(mesh, 0.9, wrong), mesh, every_sample()).ok());
}

TEST(Verify, HalfTheSamplesAreDrawnFromStoredTiles) {
  Mesh mesh;
  testing::add_triangle(mesh, {0.5, 0.5, 0.5}, {1, 0.5, 0.5}, {0.5, 1, 0.5});
  const Grid wide{{400, 400, 400}, {0, 0, 0}, {0.5, 0.5, 0.5}};
  DistanceField field(wide, 1);
  const auto tile = field.store_tile(0, 0, 0);
  for (int n = 0; n < DistanceField::kTileSamples; ++n) {
    const Vec3 p = wide.position(n % 8, n / 8 % 8, n / 64);
    tile[n] = static_cast<float>(std::min(1.0, brute_distance(mesh, p)));
  }
  const VerifyResult found = verify(field, mesh);
  EXPECT_TRUE(found.ok());
  EXPECT_EQ(found.samples, 1000);
  EXPECT_GT(found.samples_band, 20);
}

TEST(Verify, SameSamplesForAnyThreadsOtherSamplesForAnotherSeed) {
  const Mesh mesh = random_soup(6, 40, 1, 0.4);
  const auto field = field_of(mesh, kUnlimited);
  const auto largest = [&](std::uint64_t seed, int threads) {
    return verify(field, mesh, {.samples = 50, .seed = seed, .execution = {.threads = threads}}).largest.position;
  };
  EXPECT_EQ(largest(1, 1), largest(1, 2));
  EXPECT_NE(largest(1, 1), largest(2, 1));
}

TEST(Verify, TellsAnotherMesh) {
  const Mesh mesh = random_soup(7, 40, 1, 0.4);
  auto field = field_of(mesh, 0.2);
  field.set_provenance({.mesh_hash = content_hash(mesh)});
  EXPECT_FALSE(verify(field, mesh).mesh_differs);
  field.set_provenance({.mesh_hash = content_hash(mesh) ^ 1});
  EXPECT_TRUE(verify(field, mesh).mesh_differs);
}

TEST(Verify, Errors) {
  const Mesh mesh = random_soup(8, 4, 1, 0.4);
  const auto field = field_of(mesh, 0.2);
  const auto code = [&](MeshView of, const VerifyOptions& options) {
    try {
      verify(field, of, options);
    } catch (const Error& error) {
      return static_cast<int>(error.code());
    }
    return 0;
  };
  VerifyOptions none, negative, cancelled;
  none.samples = 0;
  negative.execution.threads = -1;
  cancelled.progress = [](const Progress&) { return false; };
  EXPECT_EQ(code(mesh, none), 2);
  EXPECT_EQ(code(mesh, negative), 2);
  EXPECT_EQ(code(mesh, cancelled), 130);
  EXPECT_EQ(code(Mesh{}, {}), 3);
  EXPECT_EQ(code(mesh, {}), 0);
}

// Distances there are infinite in double, and so is the allowed error.
TEST(Verify, AGridBeyondTheRangeOfDoubleMatchesNoMesh) {
  const Mesh mesh = testing::random_soup(1, 10, 1, 1);
  const DistanceField field({{4, 4, 4}, {1e160, 0, 0}}, 2);
  EXPECT_EQ(verify(field, mesh).samples_wrong, 64);
}

}  // namespace
}  // namespace standoff
