// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
// A field that follows its mesh has the bits of compute() after each move, whatever came before.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "standoff/update.h"
#include "tests/support/changed_mesh.h"
#include "tests/support/expect_error.h"
#include "tests/support/random_mesh.h"
#include "tests/support/sanitized.h"
#include "tests/support/updated_fields.h"
#include "tests/support/welded_ball.h"

namespace standoff::testing::live_field {
namespace {

const Vec3 kPlace{1000.1, -20000.3, 0.7};  // far from the origin
const Grid kGrid{{61, 53, 67}, kPlace - Vec3{1.25, 1.3, 1.35}, {0.042, 0.048, 0.04}};

Mesh placed(const Mesh& mesh) { return moved(mesh, kPlace); }
Mesh ball() { return placed(welded_ball(0.9, 8)); }
Mesh open_ball() { return with_hole(ball(), 20, 25); }
// Three that do not touch, the last one in the first.
Mesh balls() {
  Mesh mesh = welded_ball(0.6, 6, {-0.5, 0, 0});
  append(mesh, welded_ball(0.25, 4, {0.7, 0.5, 0.4}));
  append(mesh, welded_ball(0.2, 3, {-0.5, 0.1, 0}));
  return placed(mesh);
}
Mesh hollow_ball() { return placed(joined(welded_ball(0.9, 7), reversed(welded_ball(0.5, 5)))); }
Mesh unwelded_ball() { return unwelded(ball()); }

void expect_as_computed(LiveField& live, const Grid& grid, double thickness, const ComputeOptions& options) {
  const DistanceField anew = compute(live.mesh(), grid, thickness, options).field;
  const DistanceField& field = live.field();
  EXPECT_EQ(field.grid(), anew.grid());
  EXPECT_EQ(field.has_nearest(), anew.has_nearest());
  EXPECT_EQ(field.provenance().mesh_hash, anew.provenance().mesh_hash);
  EXPECT_EQ(field.provenance().sign, anew.provenance().sign);
  EXPECT_EQ(field.provenance().method, anew.provenance().method);
  EXPECT_EQ(differing_tiles(field, anew), 0);
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vec3 vector(double most) { return {in(-most, most), in(-most, most), in(-most, most)}; }
  std::uint32_t below(std::size_t count) {
    return static_cast<std::uint32_t>(std::uniform_int_distribution<std::size_t>(0, count - 1)(engine_));
  }

 private:
  std::mt19937 engine_;
};

struct Move {
  std::vector<std::uint32_t> vertices;
  std::vector<Vec3> positions;
};

// A bump around a place, moved by a vector that fades out.
Move bump(const MeshView& mesh, Vec3 at, double radius, Vec3 by_that) {
  Move move;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const double away = length(mesh.vertices[v] - at) / radius;
    if (!(away < 1)) continue;
    move.vertices.push_back(v);
    move.positions.push_back(mesh.vertices[v] + by_that * ((1 - away) * (1 - away)));
  }
  return move;
}

// What a tool, an animation or a slip may do to a mesh.
Move any_move(const MeshView& mesh, const Mesh& first, Random& random) {
  const std::uint32_t v = random.below(mesh.vertices.size());
  const Vec3 at = mesh.vertices[v];
  switch (random.below(9)) {
    case 0:  // a spike; it may cross others
      return {{v}, {at + random.vector(0.8)}};
    case 1:  // two vertices become one place
      return {{v}, {mesh.vertices[random.below(mesh.vertices.size())]}};
    case 2:  // a vertex leaves the grid, and may come back
      return {{v}, {at + random.vector(30)}};
    case 3: {  // back to where some were at first
      Move move;
      for (std::uint32_t n = v; n < std::min<std::size_t>(v + 40, mesh.vertices.size()); ++n) {
        move.vertices.push_back(n);
        move.positions.push_back(first.vertices[n]);
      }
      return move;
    }
    case 4: {  // a triangle degenerates
      const Triangle t = mesh.triangles[random.below(mesh.triangles.size())];
      return {{t[0]}, {mesh.vertices[t[1]]}};
    }
    case 5: {  // named twice, and some that do not move
      const Vec3 to = at + random.vector(0.1);
      return {{v, 0, v}, {at + random.vector(1), mesh.vertices[0], v == 0 ? mesh.vertices[0] : to}};
    }
    default:
      return bump(mesh, at, random.in(0.1, 0.5), (kPlace - at) * 0.1 + random.vector(0.15));
  }
}

struct Case {
  const char* name;
  Mesh mesh;
  ComputeOptions options;
  double thickness;
  bool is_local = true;  ///< many moves are; else fewer are made, as most take as long as computing
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto nearest = [](ComputeOptions options) {
    options.nearest = true;
    return options;
  };
  const auto odd = [](ComputeOptions options) {
    options.sign.rule = WindingRule::odd;
    options.sign.invert = true;
    return options;
  };
  all.push_back({"ball", ball(), update_options(SignMethod::automatic), 0.1});
  all.push_back({"ball, nearest", ball(), nearest(update_options(SignMethod::automatic)), 0.3});
  all.push_back({"ball, as oriented", ball(), update_options(SignMethod::winding, true), 0.06});
  all.push_back({"balls", balls(), update_options(SignMethod::automatic), 0.1});
  all.push_back({"balls, odd", balls(), odd(update_options(SignMethod::winding, true)), 0.1});
  all.push_back({"balls, parity", balls(), update_options(SignMethod::parity), 0.1});
  all.push_back({"hollow", hollow_ball(), update_options(SignMethod::automatic), 0.1, false});
  all.push_back({"hollow, as oriented", hollow_ball(), update_options(SignMethod::winding, true), 0.1});
  all.push_back({"inside out", reversed(ball()), update_options(SignMethod::automatic), 0.1, false});
  all.push_back({"unwelded", unwelded_ball(), update_options(SignMethod::winding, true), 0.1, false});
  all.push_back({"open", open_ball(), update_options(SignMethod::automatic), 0.1, false});
  all.push_back({"open, none", open_ball(), nearest(update_options(SignMethod::none)), 0.1});
  all.push_back({"open, shell", open_ball(), update_options(SignMethod::shell), 0.1});
  all.push_back({"soup", placed(random_soup(3, 300, 1, 0.1)), nearest(update_options(SignMethod::none)), 0.1});
  all.push_back({"nasty", placed(nasty_soup(5, 200, 1)), nearest(update_options(SignMethod::none)), 0.2});
  all.push_back({"nasty, signed", placed(nasty_soup(5, 60, 1)), update_options(SignMethod::automatic), 0.06, false});
  return all;
}

TEST(LiveField, AnyMovesInSequence) {
  for (const Case& one : cases()) {
    const int moves = !one.is_local ? 3 : kSanitized ? 10 : 200;
    int local = 0;
    SCOPED_TRACE(one.name);
    Random random(7);
    LiveField live(one.mesh, kGrid, one.thickness, one.options);
    expect_as_computed(live, kGrid, one.thickness, one.options);
    for (int n = 0; n < moves; ++n) {
      const Move move = any_move(live.mesh(), one.mesh, random);
      UpdateReport report;
      try {
        report = live.move(move.vertices, move.positions);
      } catch (const Error& error) {
        // Parity and far vertices have errors of their own; the mesh is as before.
        EXPECT_TRUE(error.code() == ErrorCode::input && one.options.sign.method == SignMethod::parity) << error.what();
      }
      EXPECT_EQ(report.why.empty(), !report.anew);
      EXPECT_LE(report.tiles_changed, report.tiles_computed);
      local += !report.anew;
      if (n < 30 || n % 5 == 4) expect_as_computed(live, kGrid, one.thickness, one.options);
      if (::testing::Test::HasFailure()) FAIL() << "at move " << n;
    }
    if (one.is_local) {
      EXPECT_GT(5 * local, moves);
    }
  }
}

// Bumps alone keep a mesh closed: nothing is computed anew, and every tenth field is compared.
TEST(LiveField, BumpsAreLocal) {
  Random random(11);
  const std::vector<std::pair<Mesh, ComputeOptions>> all{{balls(), update_options(SignMethod::none)},
                                                         {balls(), update_options(SignMethod::automatic)},
                                                         {balls(), update_options(SignMethod::parity)},
                                                         {unwelded_ball(), update_options(SignMethod::winding, true)}};
  for (const auto& [mesh, options] : all) {
    const Grid grid{{101, 93, 117}, kPlace - Vec3{1.25, 1.3, 1.35}, {0.025, 0.028, 0.023}};
    LiveField live(mesh, grid, 0.05, options);
    for (int n = 0; n < (kSanitized ? 10 : 100); ++n) {
      const Vec3 at = live.mesh().vertices[random.below(live.mesh().vertices.size())];
      const Move move = bump(live.mesh(), at, 0.15, random.vector(0.03));
      const UpdateReport report = live.move(move.vertices, move.positions);
      EXPECT_FALSE(report.anew) << report.why;
      EXPECT_LT(report.tiles_computed, live.field().tile_count().count() / 4);
      if (n % 10 == 9) expect_as_computed(live, grid, 0.05, options);
    }
  }
}

// What a part leaves behind turns to outside, in tiles that no triangle comes near.
TEST(LiveField, PartsTravelFarAndReturn) {
  const Grid fine{{201, 209, 217}, kPlace - Vec3{1.25, 1.3, 1.35}, {0.0125, 0.0125, 0.0125}};
  Mesh mesh = welded_ball(0.45, 6, {-0.6, 0, 0});
  const std::size_t moving = mesh.vertices.size();
  append(mesh, welded_ball(0.3, 8, {0.7, 0.1, 0.2}));
  mesh = placed(mesh);
  const ComputeOptions options = update_options(SignMethod::automatic);
  LiveField live(mesh, fine, 0.02, options);
  std::vector<std::uint32_t> vertices(moving);
  std::iota(vertices.begin(), vertices.end(), 0u);
  Random random(3);
  for (const Vec3& by_that : {Vec3{0.05, 0.5, -0.6}, Vec3{0.9, 0, 0}, Vec3{30, 0, 0}, Vec3{0, -1e6, 0}, Vec3{}}) {
    std::vector<Vec3> positions;
    for (const std::uint32_t v : vertices) positions.push_back(mesh.vertices[v] + by_that);
    EXPECT_FALSE(live.move(vertices, positions).anew);
    expect_as_computed(live, fine, 0.02, options);
  }
}

// Parts that turn inside out, grow and shrink by large factors: the sums that say whether they face outwards.
TEST(LiveField, PartsTurnAndScale) {
  const ComputeOptions options = update_options(SignMethod::automatic);
  const Mesh mesh = balls();
  const Vec3 middle = kPlace + Vec3{0.7, 0.5, 0.4};
  LiveField live(mesh, kGrid, 0.1, options);
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    if (length(mesh.vertices[v] - middle) < 0.3) vertices.push_back(v);
  for (const double factor : {1.1, -1.0, 1.0, 1e-9, 0.0, 1.0, 1e6, 1.0, -1e6, 0.5}) {
    std::vector<Vec3> positions;
    for (const std::uint32_t v : vertices) positions.push_back(middle + (mesh.vertices[v] - middle) * factor);
    live.move(vertices, positions);
    expect_as_computed(live, kGrid, 0.1, options);
  }
}

// A mesh that tears is open until it heals: both steps change signs far away.
TEST(LiveField, TearsAndHeals) {
  for (const SignMethod method : {SignMethod::winding, SignMethod::none}) {
    const ComputeOptions options = update_options(method, method == SignMethod::winding);
    const Mesh mesh = unwelded_ball();
    LiveField live(mesh, kGrid, 0.06, options);
    for (int n = 0; n < 3; ++n) {
      std::vector<std::uint32_t> vertices(3 * (1 + static_cast<std::size_t>(n)));
      std::iota(vertices.begin(), vertices.end(), 30u * static_cast<std::uint32_t>(n));
      std::vector<Vec3> away, back;
      for (const std::uint32_t v : vertices) {
        back.push_back(mesh.vertices[v]);
        away.push_back(mesh.vertices[v] + Vec3{0.2, 0.1, 0.3});
      }
      EXPECT_EQ(live.move(vertices, away).anew, method == SignMethod::winding);
      expect_as_computed(live, kGrid, 0.06, options);
      EXPECT_EQ(live.move(vertices, back).anew, method == SignMethod::winding);
      expect_as_computed(live, kGrid, 0.06, options);
      const Move move = bump(live.mesh(), mesh.vertices[100], 0.2, {0.02, 0.01, 0});
      EXPECT_FALSE(live.move(move.vertices, move.positions).anew);
      expect_as_computed(live, kGrid, 0.06, options);
      live.move(vertices, back);
    }
  }
}

// After all of it moved, a part of it does.
TEST(LiveField, AllMoves) {
  for (const SignMethod method : {SignMethod::automatic, SignMethod::none}) {
    const ComputeOptions options = update_options(method);
    LiveField live(ball(), kGrid, 0.06, options);
    Move all;
    for (std::uint32_t v = 0; v < live.mesh().vertices.size(); ++v) {
      all.vertices.push_back(v);
      all.positions.push_back(live.mesh().vertices[v] + Vec3{0.1, 0.05, -0.1});
    }
    EXPECT_TRUE(live.move(all.vertices, all.positions).anew);
    expect_as_computed(live, kGrid, 0.06, options);
    const Move move = bump(live.mesh(), live.mesh().vertices[20], 0.2, {0.02, 0.01, 0});
    EXPECT_FALSE(live.move(move.vertices, move.positions).anew);
    expect_as_computed(live, kGrid, 0.06, options);
  }
}

TEST(LiveField, NothingMoves) {
  const ComputeOptions options = update_options(SignMethod::automatic);
  LiveField live(ball(), kGrid, 0.1, options);
  const UpdateReport none = live.move({}, {});
  EXPECT_EQ(none.triangles_changed + none.windows + none.tiles_computed + none.tiles_changed, 0);
  const std::vector<std::uint32_t> some{3, 9};
  const std::vector<Vec3> where{live.mesh().vertices[3], live.mesh().vertices[9]};
  EXPECT_EQ(live.move(some, where).triangles_changed, 0);
  expect_as_computed(live, kGrid, 0.1, options);
  EXPECT_EQ(live.report().sign.method, SignMethod::winding);
}

TEST(LiveField, WithoutAHash) {
  ComputeOptions options = update_options(SignMethod::none);
  options.hash_mesh = false;
  LiveField live(ball(), kGrid, 0.1, options);
  EXPECT_EQ(live.field().provenance().mesh_hash, 0u);
}

TEST(LiveField, FullFieldsAreComputedAnew) {
  const Grid small{{21, 19, 23}, kPlace - Vec3{1.25, 1.3, 1.35}, {0.12, 0.13, 0.11}};
  for (const SignMethod method : {SignMethod::winding, SignMethod::flood, SignMethod::normal}) {
    const ComputeOptions options = update_options(method);
    LiveField live(ball(), small, kFullField, options);
    const Move move = bump(live.mesh(), live.mesh().vertices[5], 0.3, {0.1, 0.1, 0});
    EXPECT_TRUE(live.move(move.vertices, move.positions).anew);
    expect_as_computed(live, small, kFullField, options);
  }
}

TEST(LiveField, ErrorsChangeNothing) {
  bool stop = false;
  int calls = 0, most = 0;
  ComputeOptions options = update_options(SignMethod::automatic);
  ComputeOptions watched = options;
  watched.progress = [&](const Progress&) { return !stop || calls++ < most; };
  LiveField live(ball(), kGrid, 0.1, watched);
  const Mesh mesh = ball();
  const Move good = bump(mesh, mesh.vertices[50], 0.3, {0.1, 0.1, 0.1});
  const auto expect_as_before = [&] {
    EXPECT_TRUE(std::ranges::equal(live.mesh().vertices, mesh.vertices));
    expect_as_computed(live, kGrid, 0.1, options);
  };
  const auto fails = [&](const Move& move, ErrorCode code, const char* text) {
    expect_error([&] { live.move(move.vertices, move.positions); }, code, text);
    expect_as_before();
  };
  fails({{1, 2}, {mesh.vertices[1]}}, ErrorCode::usage, "give one for each");
  fails({{1'000'000}, {mesh.vertices[1]}}, ErrorCode::usage, "does not exist");
  Move bad = good;
  bad.positions.back().y = std::numeric_limits<double>::quiet_NaN();
  fails(bad, ErrorCode::input, "is not finite");
  bad.positions.back().y = 1e300;
  fails(bad, ErrorCode::limit, "farther than");
  for (; most < 12; ++most) {
    stop = true;
    calls = 0;
    try {
      live.move(good.vertices, good.positions);
      stop = false;
      break;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::interrupted);
      stop = false;
      expect_as_before();
    }
  }
  EXPECT_GT(most, 3);
  live.move(good.vertices, good.positions);
  expect_as_computed(live, kGrid, 0.1, options);
}

TEST(LiveField, TheLimitCountsWhatIsKept) {
  ComputeOptions options = update_options(SignMethod::automatic);
  options.memory_limit = 20'000;
  expect_error([&] { LiveField live(ball(), kGrid, 0.1, options); }, ErrorCode::limit, "kept");
  options.memory_limit = 1'000'000;
  expect_error([&] { LiveField live(ball(), kGrid, 0.1, options); }, ErrorCode::limit, "may need");
  options.memory_limit = 1'000'000'000;
  LiveField live(ball(), kGrid, 0.1, options);
  const Move move = bump(live.mesh(), live.mesh().vertices[5], 0.3, {0.1, 0.1, 0});
  EXPECT_FALSE(live.move(move.vertices, move.positions).anew);
}

// An eighth of what is left is for crossings, where rows decide the sign. Where these are too many, at once or in the
// end, they are found for each window.
TEST(LiveField, TheLimitCountsCrossings) {
  const auto limit_of_field = [](SignMethod method) {
    ComputeOptions options = update_options(method);
    options.memory_limit = 300'000;
    try {
      LiveField live(ball(), kGrid, 0.1, options);
    } catch (const Error& error) {
      return error.details().bytes_limit.value_or(0);
    }
    return std::int64_t{0};
  };
  const std::int64_t left = limit_of_field(SignMethod::none);
  EXPECT_GT(left, 0);
  EXPECT_EQ(limit_of_field(SignMethod::automatic), left - left / 8);

  const Mesh mesh = ball();
  const Grid grid{{61, 253, 267}, kPlace - Vec3{1.25, 1.3, 1.35}, {0.042, 0.01, 0.01}};
  ComputeOptions options = update_options(SignMethod::automatic);
  options.memory_limit = estimate(mesh, grid, 0.05, options).whole * 3 / 2;
  LiveField live(mesh, grid, 0.05, options);
  Random random(5);
  for (int n = 0; n < (kSanitized ? 3 : 12); ++n) {
    const Vec3 at = live.mesh().vertices[random.below(mesh.vertices.size())];
    const Move move = bump(live.mesh(), at, 0.2, random.vector(0.2));
    live.move(move.vertices, move.positions);
    expect_as_computed(live, grid, 0.05, options);
  }
}

TEST(LiveField, PositionsOfItsOwnMesh) {
  const ComputeOptions options = update_options(SignMethod::none);
  const Mesh mesh = ball();
  LiveField live(mesh, kGrid, 0.1, options);
  const std::vector<std::uint32_t> vertices{1, 2, 3};
  const auto* const own = reinterpret_cast<const Vec3*>(live.mesh().vertices.data());
  live.move(vertices, {own, 3});  // vertex 1 to where 0 is, 2 to where 1 was
  for (std::size_t v = 1; v < 4; ++v) EXPECT_EQ(live.mesh().vertices[v], mesh.vertices[v - 1]);
  expect_as_computed(live, kGrid, 0.1, options);
}

TEST(LiveField, MovesAsAnObject) {
  LiveField live(ball(), kGrid, 0.1, update_options(SignMethod::none));
  LiveField other = std::move(live);
  const Move move = bump(other.mesh(), other.mesh().vertices[5], 0.3, {0.1, 0.1, 0});
  other.move(move.vertices, move.positions);
  expect_as_computed(other, kGrid, 0.1, update_options(SignMethod::none));
}

}  // namespace
}  // namespace standoff::testing::live_field
