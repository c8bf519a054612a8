// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
// An updated field is that of the new mesh: every sample, nearest triangle, stored tile and the provenance.
#include "standoff/update.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "standoff/testing/emulation.h"
#include "tests/collision/bodies.h"
#include "tests/support/changed_mesh.h"
#include "tests/support/expect_error.h"
#include "tests/support/random_mesh.h"
#include "tests/support/sanitized.h"
#include "tests/support/updated_fields.h"
#include "tests/support/welded_ball.h"

namespace standoff::testing {
namespace {

const Vec3 kFar{1000.1, -20000.3, 0.7};
const Grid kUpdateGrid{{101, 93, 117}, kFar - Vec3{1.25, 1.3, 1.35}, {0.025, 0.028, 0.023}};
constexpr double kThin = 0.06, kThick = 0.16;  // of 2 and 6 spacings

Mesh at_grid(const Mesh& mesh) { return moved(mesh, kFar); }
Mesh ball() { return at_grid(welded_ball(1, 12)); }
Mesh open_ball() { return with_hole(ball(), 40, 55); }

// Every tile alike: values, nearest triangles, marks.
void expect_same(const DistanceField& updated, const DistanceField& anew) {
  EXPECT_EQ(updated.grid(), anew.grid());
  EXPECT_EQ(updated.provenance().mesh_hash, anew.provenance().mesh_hash);
  EXPECT_EQ(updated.provenance().sign, anew.provenance().sign);
  EXPECT_EQ(updated.provenance().method, anew.provenance().method);
  EXPECT_EQ(updated.provenance().version, anew.provenance().version);
  ASSERT_EQ(updated.has_nearest(), anew.has_nearest());
  EXPECT_EQ(updated.stored_tiles(), anew.stored_tiles());
  EXPECT_EQ(differing_tiles(updated, anew), 0) << "tiles of " << anew.tile_count().count();
}

// Updates the field of `before` to `after` and compares it with the field computed anew.
UpdateReport expect_update(const Mesh& before, const Mesh& after, double thickness, const ComputeOptions& options,
                           const Grid& grid = kUpdateGrid) {
  DistanceField field = compute(before, grid, thickness, options).field;
  const UpdateReport report = update_field(before, after, changed_triangles(before, after), field, options);
  expect_same(field, compute(after, grid, thickness, options).field);
  EXPECT_EQ(report.why.empty(), !report.anew);
  EXPECT_EQ(report.tiles_stored, field.stored_tiles());
  EXPECT_LE(report.tiles_changed, report.tiles_computed);
  return report;
}

// Moves the vertices within `radius` of a point by up to `most`, by a smooth bump.
Mesh dented(Mesh mesh, Vec3 at, double radius, Vec3 by) {
  for (Vec3& v : mesh.vertices) {
    const double away = length(v - at) / radius;
    if (away < 1) v = v + by * ((1 - away) * (1 - away));
  }
  return mesh;
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vec3 vector(double most) { return {in(-most, most), in(-most, most), in(-most, most)}; }
  std::size_t below(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(engine_); }

 private:
  std::mt19937 engine_;
};

Vec3 somewhere_on(const Mesh& mesh, Random& random) { return mesh.vertices[random.below(mesh.vertices.size())]; }

TEST(Update, LocalMoves) {
  Random random(1);
  for (const bool welded : {true, false})
    for (const SignMethod method : {SignMethod::none, SignMethod::automatic, SignMethod::parity})
      for (const double thickness : {0.01, kThin, kThick})
        for (const bool nearest : {false, true}) {
          SCOPED_TRACE(std::string(find_info(method)->name) + ", " + std::to_string(thickness));
          const Mesh before = welded ? ball() : unwelded(ball());
          const Mesh after = dented(before, somewhere_on(before, random), 0.25, random.vector(0.15));
          ComputeOptions options = update_options(method);
          options.nearest = nearest;
          // Parts of one triangle each are not known to face outwards.
          options.sign.as_oriented = !welded && method == SignMethod::automatic;
          const UpdateReport report = expect_update(before, after, thickness, options);
          EXPECT_FALSE(report.anew) << report.why;
          EXPECT_GT(report.tiles_changed, 0);
          EXPECT_LT(report.tiles_computed, kUpdateGrid.sample_count() / 512 / 2);
        }
}

// Alone, a moved triangle opens the mesh; its signs are then decided anew.
TEST(Update, ScatteredMoves) {
  Random random(2);
  for (const SignMethod method : {SignMethod::none, SignMethod::automatic, SignMethod::shell}) {
    const Mesh before = unwelded(ball());
    Mesh after = before;
    for (int n = 0; n < 5; ++n) {
      const std::size_t t = random.below(after.triangles.size());
      const Vec3 by_that = random.vector(0.2);
      for (const std::uint32_t v : after.triangles[t]) after.vertices[v] = after.vertices[v] + by_that;
    }
    const UpdateReport report = expect_update(before, after, kThin, update_options(method));
    EXPECT_EQ(report.anew, method == SignMethod::automatic) << report.why;
  }
  const Mesh before = ball();
  Mesh after = before;
  for (int n = 0; n < 6; ++n) {
    Vec3& v = after.vertices[random.below(after.vertices.size())];
    v = v + random.vector(0.1);
  }
  const UpdateReport report = expect_update(before, after, kThin, update_options(SignMethod::automatic));
  EXPECT_FALSE(report.anew) << report.why;
  EXPECT_GT(report.windows, 1);
}

// A bump sweeps a volume that the band does not reach: marks of tiles that are not stored flip, and flip back.
TEST(Update, BumpsFlipMarks) {
  const Mesh before = at_grid(welded_ball(0.7, 12));
  const Mesh after = dented(before, kFar + Vec3{0.7, 0, 0}, 0.25, {-0.9, 0.05, 0.03});
  const auto marks = [](const DistanceField& field) {
    return std::ranges::count(field.slots(), DistanceField::kInside);
  };
  const ComputeOptions options = update_options(SignMethod::winding);
  const double thin = 0.02;
  EXPECT_NE(marks(compute(before, kUpdateGrid, thin, options).field),
            marks(compute(after, kUpdateGrid, thin, options).field));
  for (const WindingRule rule : {WindingRule::positive, WindingRule::nonzero, WindingRule::odd})
    for (const bool invert : {false, true}) {
      ComputeOptions asked = options;
      asked.sign.rule = rule;
      asked.sign.invert = invert;
      EXPECT_FALSE(expect_update(before, after, thin, asked).anew);
      EXPECT_FALSE(expect_update(after, before, thin, asked).anew);
    }
}

// A whole part moves: what it leaves turns to outside, in bricks that no triangle comes near.
TEST(Update, PartsMove) {
  const Grid fine{{201, 209, 217}, kUpdateGrid.origin, {0.0125, 0.0125, 0.0125}};
  Mesh before = at_grid(welded_ball(0.45, 6, {-0.6, 0, 0}));
  const std::size_t moving = before.vertices.size();
  append(before, at_grid(welded_ball(0.3, 8, {0.7, 0.1, 0.2})));
  for (const Vec3& by_that : {Vec3{0.05, 0.5, -0.6}, Vec3{0.9, 0, 0}, Vec3{30, 0, 0}, Vec3{0, -1e6, 0}}) {
    Mesh after = before;
    for (std::size_t v = 0; v < moving; ++v) after.vertices[v] = after.vertices[v] + by_that;
    for (const SignMethod method : {SignMethod::none, SignMethod::automatic}) {
      EXPECT_FALSE(expect_update(before, after, 0.02, update_options(method), fine).anew);
      EXPECT_FALSE(expect_update(after, before, 0.02, update_options(method), fine).anew);
    }
  }
}

TEST(Update, EverySign) {
  Random random(3);
  const std::vector<Mesh> meshes{ball(), open_ball(), at_grid(random_soup(3, 400, 1, 0.1)),
                                 at_grid(nasty_soup(3, 60, 1))};
  for (const SignMethodInfo& sign : kSignMethods)
    for (std::size_t n = 0; n < meshes.size(); ++n)
      for (const bool invert : {false, true}) {
        if (sign.method == SignMethod::parity && n != 0) continue;  // closed meshes alone
        if (sign.method == SignMethod::none && invert) continue;
        if (kSanitized && invert != (n % 2 != 0)) continue;
        SCOPED_TRACE(std::string(sign.name) + ", mesh " + std::to_string(n));
        ComputeOptions options = update_options(sign.method);
        options.sign.invert = invert;
        options.nearest = n == 1;
        const Mesh after = dented(meshes[n], somewhere_on(meshes[n], random), 0.25, random.vector(0.15));
        const UpdateReport report = expect_update(meshes[n], after, n == 2 ? kThick : kThin, options);
        const bool is_local = sign.method == SignMethod::none || sign.method == SignMethod::shell ||
                              (n == 0 && (sign.method == SignMethod::winding || sign.method == SignMethod::parity ||
                                          sign.method == SignMethod::automatic));
        if (n != 3) {
          EXPECT_EQ(report.anew, !is_local) << report.why;
        }
      }
}

// What is decided for the whole field is computed anew.
TEST(Update, AnewWhereItMustBe) {
  const Mesh before = ball();
  const Mesh after = dented(before, before.vertices[100], 0.25, {0.1, 0.1, 0});
  const ComputeOptions winding = update_options(SignMethod::winding);
  const Grid small{{21, 19, 23}, kFar - Vec3{1.25, 1.3, 1.35}, {0.12, 0.13, 0.11}};
  EXPECT_TRUE(expect_update(before, after, kFullField, winding, small).anew);
  ComputeOptions thesis = winding;
  thesis.method = Method::thesis;
  EXPECT_TRUE(expect_update(before, after, 0.2, thesis, small).anew);
  ComputeOptions skip = winding;
  skip.skip.kind = SkipRule::Kind::neighbour;
  EXPECT_TRUE(expect_update(before, after, 0.2, skip, small).anew);
  skip.skip.kind = SkipRule::Kind::exact;
  EXPECT_FALSE(expect_update(before, after, kThin, skip).anew);
  ComputeOptions outer = winding;
  outer.sign.outer = true;
  EXPECT_TRUE(expect_update(before, after, 0.2, outer, small).anew);
  Mesh all = before;
  for (Vec3& v : all.vertices) v = v + Vec3{0.01, 0, 0};
  EXPECT_TRUE(expect_update(before, all, 0.2, winding, small).anew);
  // Its octants face in and out.
  const Mesh unoriented = at_grid(ball_mesh(1, 12));
  EXPECT_TRUE(
      expect_update(unoriented, dented(unoriented, unoriented.vertices[50], 0.2, {0.1, 0, 0}), 0.2, winding, small)
          .anew);
  // Closed before, open afterwards, and the other way round.
  const ComputeOptions automatic = update_options(SignMethod::automatic);
  EXPECT_TRUE(expect_update(before, open_ball(), kThin, automatic).anew);
  EXPECT_TRUE(expect_update(open_ball(), before, kThin, automatic).anew);
  // Inside out: it is turned, before or afterwards.
  Mesh turned = after;
  for (Triangle& t : turned.triangles) std::swap(t[1], t[2]);
  EXPECT_TRUE(expect_update(turned, before, kThin, automatic).anew);
  Mesh turned_before = before;
  for (Triangle& t : turned_before.triangles) std::swap(t[1], t[2]);
  EXPECT_TRUE(expect_update(turned_before, turned, kThin, automatic).anew);
  ComputeOptions as_oriented = winding;
  as_oriented.sign.as_oriented = true;
  EXPECT_FALSE(expect_update(turned_before, turned, kThin, as_oriented).anew);
  // The field of other options.
  DistanceField field = compute(before, kUpdateGrid, kThin, update_options(SignMethod::none)).field;
  EXPECT_TRUE(update_field(before, after, changed_triangles(before, after), field, winding).anew);
  expect_same(field, compute(after, kUpdateGrid, kThin, winding).field);
}

TEST(Update, TrianglesComeAndGo) {
  const Mesh before = ball();
  for (const SignMethod method : {SignMethod::none, SignMethod::automatic}) {
    Mesh fewer = before;
    fewer.triangles.resize(before.triangles.size() - 8);
    EXPECT_EQ(expect_update(before, fewer, kThin, update_options(method)).triangles_changed, 8);
    EXPECT_EQ(expect_update(fewer, before, kThin, update_options(method)).triangles_changed, 8);
    // A part that comes is closed of itself.
    const Mesh more = joined(before, at_grid(welded_ball(0.1, 2, {0.9, 0.9, 0.9})));
    EXPECT_FALSE(expect_update(before, more, kThin, update_options(method)).anew);
    EXPECT_FALSE(expect_update(more, before, kThin, update_options(method)).anew);
  }
}

TEST(Update, DegenerateTrianglesAndCopies) {
  const Mesh before = at_grid(nasty_soup(5, 300, 1));
  Random random(4);
  for (const double thickness : {kThin, kThick}) {
    Mesh after = before;
    for (int n = 0; n < 8; ++n) {
      Triangle& t = after.triangles[random.below(after.triangles.size())];
      t = n % 2 == 0 ? Triangle{t[0], t[0], t[2]} : after.triangles[random.below(after.triangles.size())];
    }
    ComputeOptions options = update_options(SignMethod::none);
    options.nearest = true;
    expect_update(before, after, thickness, options);
    expect_update(after, before, thickness, options);
  }
}

TEST(Update, NothingChanges) {
  const Mesh mesh = ball();
  DistanceField field = compute(mesh, kUpdateGrid, kThin, update_options(SignMethod::automatic)).field;
  const DistanceField same = field;
  const UpdateReport report = update_field(mesh, mesh, {}, field, update_options(SignMethod::automatic));
  EXPECT_EQ(report.triangles_changed + report.windows + report.tiles_computed + report.tiles_changed, 0);
  expect_same(field, same);
  // Named, but not moved; in any order, and again.
  const std::vector<std::uint32_t> named{7, 3, 7, 100};
  EXPECT_EQ(update_field(mesh, mesh, named, field, update_options(SignMethod::automatic)).triangles_changed, 0);
  expect_same(field, same);
}

TEST(Update, OtherIndicesAreNoChange) {
  const Mesh mesh = ball();
  Mesh after = mesh;
  after.vertices.push_back({1, 2, 3});
  std::swap(after.vertices[3], after.vertices[90]);
  for (Triangle& t : after.triangles)
    for (std::uint32_t& v : t) v = v == 3 ? 90 : v == 90 ? 3 : v;
  const UpdateReport report = expect_update(mesh, after, kThin, update_options(SignMethod::automatic));
  EXPECT_EQ(report.anew, false);
  EXPECT_EQ(report.triangles_changed, 0);
}

// A field of a window has its bricks where the whole grid has them.
TEST(Update, FieldsOfWindows) {
  const Grid window = kUpdateGrid.window({16, 32, 48}, {72, 61, 69});
  const Mesh before = ball();
  const Mesh after = dented(before, kFar + Vec3{0.2, 0.2, 0.9}, 0.3, {0.1, 0.1, -0.2});
  for (const SignMethod method : {SignMethod::none, SignMethod::winding})
    EXPECT_FALSE(expect_update(before, after, kThin, update_options(method), window).anew);
}

TEST(Update, OnAnEmulatedGpu) {
  ComputeOptions options = update_options(SignMethod::winding);
  options.execution.backend = kEmulated;
  options.nearest = true;
  const Mesh before = at_grid(welded_ball(1, 4));
  const Mesh after = dented(before, kFar + Vec3{0, 0, 1}, 0.4, {0.1, 0.1, -0.2});
  EXPECT_FALSE(expect_update(before, after, kThin, options).anew);
}

// One after the other, no error is left behind.
void update_on_and_on(const ComputeOptions& options, double thickness, int rounds) {
  Random random(5);
  Mesh mesh = at_grid(welded_ball(0.9, 8));
  const Grid grid{{67, 61, 71}, kFar - Vec3{1.25, 1.3, 1.35}, {0.038, 0.041, 0.037}};
  DistanceField field = compute(mesh, grid, thickness, options).field;
  std::int64_t anew = 0;
  for (int round = 0; round < rounds; ++round) {
    const Vec3 at = somewhere_on(mesh, random);
    // Towards the middle if it is far out, so that the mesh stays about the grid.
    const Vec3 back = (kFar - at) * (length(at - kFar) > 1.2 ? 0.5 : 0.05);
    const Mesh after = dented(mesh, at, random.in(0.05, 0.3), back + random.vector(0.15));
    anew += update_field(mesh, after, changed_triangles(mesh, after), field, options).anew;
    mesh = after;
    if (round % 50 == 49) expect_same(field, compute(mesh, grid, thickness, options).field);
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_LT(anew, rounds / 10);
}
TEST(Update, ThousandsInSequence) {
  ComputeOptions nearest = update_options(SignMethod::automatic);
  nearest.nearest = true;
  const int share = kSanitized ? 20 : 1;
  update_on_and_on(update_options(SignMethod::automatic), 0.04, 1000 / share);
  update_on_and_on(nearest, 0.12, 600 / share);
  update_on_and_on(update_options(SignMethod::none), 0.2, 400 / share);
}

TEST(Update, ErrorsLeaveTheFieldAsItWas) {
  const Mesh before = ball();
  const Mesh after = dented(before, before.vertices[100], 0.25, {0.1, 0.1, 0});
  const std::vector<std::uint32_t> changed = changed_triangles(before, after);
  const ComputeOptions options = update_options(SignMethod::automatic);
  DistanceField field = compute(before, kUpdateGrid, kThin, options).field;
  const DistanceField same = field;
  Mesh broken = after;
  broken.vertices[after.triangles[changed[0]][1]].y = std::numeric_limits<double>::quiet_NaN();
  expect_error([&] { update_field(before, broken, changed, field, options); }, ErrorCode::input, "is not finite");
  broken = after;
  broken.triangles[changed[0]][1] = 1'000'000;
  expect_error([&] { update_field(before, broken, changed, field, options); }, ErrorCode::input, "out of range");
  // Even where the list does not say so.
  broken = after;
  broken.triangles[0][1] = 1'000'000;
  expect_error([&] { update_field(before, broken, changed, field, options); }, ErrorCode::input, "out of range");
  broken = before;
  broken.triangles[changed[0]][1] = 1'000'000;
  ComputeOptions unhashed = options;
  unhashed.hash_mesh = false;
  expect_error([&] { update_field(broken, after, changed, field, unhashed); }, ErrorCode::input, "mesh before");
  broken = after;
  broken.vertices[after.triangles[changed[0]][1]].y = 1e300;
  expect_error([&] { update_field(before, broken, changed, field, options); }, ErrorCode::limit, "farther than");
  expect_error([&] { update_field(after, before, changed, field, options); }, ErrorCode::usage, "not that of the mesh");
  expect_error([&] { update_field(after, after, {}, field, options); }, ErrorCode::usage, "not that of the mesh");
  const std::vector<std::uint32_t> beyond{static_cast<std::uint32_t>(before.triangles.size())};
  expect_error([&] { update_field(before, after, beyond, field, options); }, ErrorCode::usage, "neither mesh has it");
  const MeshView null{{static_cast<const double*>(nullptr), 5}, before.triangles};
  expect_error([&] { update_field(null, after, changed, field, options); }, ErrorCode::usage, "is null");
  ComputeOptions limited = options;
  limited.memory_limit = 1000;
  expect_error([&] { update_field(before, after, changed, field, limited); }, ErrorCode::limit, "may need");
  for (int most = 0; most < 3; ++most) {
    ComputeOptions stopped = options;
    stopped.progress = [&, calls = 0](const Progress&) mutable { return calls++ < most; };
    expect_error([&] { update_field(before, after, changed, field, stopped); }, ErrorCode::interrupted, "cancelled");
  }
  expect_same(field, same);
  update_field(before, after, changed, field, options);
  expect_same(field, compute(after, kUpdateGrid, kThin, options).field);
  DistanceField empty;
  expect_error([&] { update_field(before, after, changed, empty, options); }, ErrorCode::usage, "is empty");
}

TEST(Update, ChangedTriangles) {
  const Mesh before = ball();
  EXPECT_TRUE(changed_triangles(before, before).empty());
  Mesh after = before;
  std::swap(after.vertices[3], after.vertices[90]);
  std::vector<std::uint32_t> expected;
  for (std::uint32_t t = 0; t < before.triangles.size(); ++t)
    if (std::ranges::any_of(before.triangles[t], [](std::uint32_t v) { return v == 3 || v == 90; }))
      expected.push_back(t);
  EXPECT_EQ(changed_triangles(before, after), expected);
  // Other indices of the same corners are no change.
  for (Triangle& t : after.triangles)
    for (std::uint32_t& v : t) v = v == 3 ? 90 : v == 90 ? 3 : v;
  EXPECT_TRUE(changed_triangles(before, after).empty());
  after.triangles[0][0] = 1'000'000;
  expect_error([&] { changed_triangles(before, after); }, ErrorCode::input, "out of range");
}

}  // namespace
}  // namespace standoff::testing
