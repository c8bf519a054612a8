// SPDX-License-Identifier: Apache-2.0
// Surfaces that enclose nothing, or have no sides: sheets, terrain, a Moebius strip, a Klein bottle, two-sided faces.
#include <gtest/gtest.h>

#include <tuple>

#include "tests/sign/cases/known_sides.h"
#include "tests/sign/cases/solids.h"

namespace standoff {
namespace {

using namespace testing;  // NOLINT: a test of what that folder has

Mesh flat_square() {
  Mesh mesh;
  mesh.vertices = {{-1, -1, 0.1}, {1, -1, 0.1}, {1, 1, 0.1}, {-1, 1, 0.1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}
Grid cube_about_origin(std::int64_t samples, double half) {
  const double step = 2 * half / double(samples - 1);
  return {{samples, samples, samples}, {-half, -half * 1.001, -half * 1.002}, {step, step, step}};
}

void expect_doubt(const Mesh& mesh, const Grid& grid, SignOptions sign) {
  ComputeOptions options{.sign = {SignMethod::none}};
  sign.strict = true;
  options.sign = sign;
  try {
    compute(mesh, grid, 1, options);
    ADD_FAILURE() << "no doubt by " << name_of(sign.method);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::doubt) << error.what();
  }
}

// A sheet never fills more than half of what a point sees; nothing is inside, and the user hears what to use. A strip
// without a front has no normals to tell it by.
TEST(SheetCases, SheetsHaveNoInside) {
  const Mesh sheets[] = {flat_square(), terrain(10, 0.1), moebius()};
  for (const Mesh& mesh : sheets) {
    const bool has_front = &mesh != &sheets[2];
    const Grid grid = cube_about_origin(16, 1.4);
    const SignReport report = expect_sides(mesh, grid, kAutomatic, nowhere);
    EXPECT_EQ(report.method, SignMethod::none);
    EXPECT_FALSE(report.sure);
    EXPECT_EQ(report.why.find("normal") != std::string::npos, has_front) << report.why;
    EXPECT_NE(report.why.find("shell"), std::string::npos) << report.why;
    expect_doubt(mesh, grid, kAutomatic);
    expect_doubt(mesh, grid, kWinding);
  }
}

TEST(SheetCases, WindingOnASheetWarns) {
  const SignReport report = expect_sides(flat_square(), cube_about_origin(16, 1.4), kWinding, nowhere);
  EXPECT_EQ(report.method, SignMethod::winding);
  EXPECT_FALSE(report.sure);
  EXPECT_NE(report.why.find("normal"), std::string::npos) << report.why;
  EXPECT_EQ(report.boundary_edges, 4);
}

// Above the height of the terrain's triangles, or below. Known where the foot of the point is nearer than the border,
// because then the nearest point is not on the border either.
Side below_terrain(const Mesh& mesh, Vec3 p) {
  const double to_border = std::min(1 - std::abs(p.x), 1 - std::abs(p.y));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = MeshView(mesh).corners(t);
    const auto twice_area = [&](Vec3 q, Vec3 r) { return (q.x - p.x) * (r.y - p.y) - (r.x - p.x) * (q.y - p.y); };
    const double u = twice_area(b, c), v = twice_area(c, a), w = twice_area(a, b);
    if (u < 0 || v < 0 || w < 0) continue;
    const double height = p.z - (u * a.z + v * b.z + w * c.z) / (u + v + w);
    return std::abs(height) < to_border && std::abs(height) > 1e-9 ? side_of(height < 0) : Side::unknown;
  }
  return Side::unknown;
}

TEST(SheetCases, TerrainByNormals) {
  const Mesh mesh = terrain(14, 0.25);
  const Grid grid{{30, 30, 14}, {-0.97, -0.961, -0.5}, {0.0667, 0.0663, 0.0769}};
  expect_sides(mesh, grid, kNormal, [&](Vec3 p) { return below_terrain(mesh, p); });
  expect_sides(mesh, grid, {.method = SignMethod::normal, .invert = true}, [&](Vec3 p) {
    const Side side = below_terrain(mesh, p);
    return side == Side::unknown ? side : side_of(side == Side::outside);
  });
  // Tiles beyond a thin band have the side of what is nearest to them, too.
  expect_sides(
      mesh, grid, kNormal, [&](Vec3 p) { return below_terrain(mesh, p); }, 0.02);
}

TEST(SheetCases, SolidsByNormals) {
  for (const Mesh& solid : {sphere(8), box({-1, -0.5, -0.7}, {1, 0.5, 0.7}), octahedron(1.2)})
    for (const double thickness : {0.05, kFullField}) {
      const SignReport report = expect_sides(solid, grid_around(solid, 21), kNormal, Convex(solid), thickness);
      EXPECT_EQ(report.method, SignMethod::normal);
    }
  const Mesh ring = torus(24, 12);
  expect_sides(ring, grid_around(ring, 24), kNormal, RoundTorus(24, 12, 1, 0.3));
}

// Corners of a tetrahedron where some faces are fans of many triangles, and the others one each: the fans must not
// outvote them. Beside sharp corners, the nearest face alone would tell the wrong side.
TEST(SheetCases, SharpCornersByNormals) {
  for (const double height : {0.2, 1.0, 6.0}) {
    Mesh mesh;
    mesh.vertices = {{0, 0, height}, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {1, 3, 2}, {0, 2, 3}, {0, 3, 1}};
    const Convex known(mesh);
    mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 2);
    for (int n = 0; n < 64; ++n) {  // both faces at the edge of y = -1
      const Vec3 a{-1 + n / 32.0, -1, 0}, b{-1 + (n + 1) / 32.0, -1, 0};
      add_triangle(mesh, {0, 0, height}, a, b);
      add_triangle(mesh, {0, 1, 0}, b, a);
    }
    for (const Vec3 corner : {Vec3{0, 0, height}, Vec3{-1, -1, 0}, Vec3{1, -1, 0}, Vec3{0, 1, 0}}) {
      const Grid grid{{16, 16, 16}, corner - Vec3{0.301, 0.302, 0.303}, {0.04, 0.04, 0.04}};
      expect_sides(mesh, grid, kNormal, known);
    }
  }
}

TEST(SheetCases, ShellsOfEveryMesh) {
  const double thickness = 0.22;
  for (const Mesh& mesh : {flat_square(), terrain(), moebius(), klein_bottle(), two_sided(sphere(6))}) {
    const Grid grid = grid_around(mesh, 17);
    ComputeOptions options{.sign = {SignMethod::none}};
    for (const double band : {0.4, kFullField}) {
      const std::vector<float> plain = compute(mesh, grid, band, {.sign = {SignMethod::none}}).field.to_dense();
      options.sign = {.method = SignMethod::shell, .shell = thickness};
      const ComputeResult result = compute(mesh, grid, band, options);
      EXPECT_EQ(result.report.sign.method, SignMethod::shell);
      EXPECT_TRUE(result.report.sign.sure);
      const std::vector<float> values = result.field.to_dense();
      std::int64_t wrong = 0, inside = 0;
      for (std::size_t n = 0; n < values.size(); ++n) {
        const double distance = double(plain[n]) - thickness / 2, allowed = 2 * promised_error(grid, plain[n]);
        inside += values[n] < 0;
        if (plain[n] < float(band))
          wrong += std::abs(values[n] - distance) > allowed;
        else  // no more is known of a clamped sample than that it is outside
          wrong += !(values[n] > 0 && values[n] <= float(band));
      }
      EXPECT_EQ(wrong, 0) << "thickness " << band;
      EXPECT_GT(inside, 20);
    }
  }
}

// In a section through the axis, turned by half the angle about it, the bottle is (sin v, sin 2v): |y| < 2 |x| sqrt(1 -
// x^2) is within the eight. The margin: chords of the mesh from the arcs.
Side in_bottle(Vec3 p) {
  const double half_angle = std::atan2(p.y, p.x) / 2, far = std::hypot(p.x, p.y) - 2;
  const double c = std::cos(half_angle), s = std::sin(half_angle);
  const double x = c * far + s * p.z, y = c * p.z - s * far;
  const double lobe = 2 * std::abs(x) * std::sqrt(std::max(0.0, 1 - x * x));
  return std::abs(std::abs(y) - lobe) < 0.15 || std::abs(std::abs(x) - 1) < 0.05 ? Side::unknown
                                                                                 : side_of(std::abs(y) < lobe);
}

TEST(SheetCases, KleinBottle) {
  const Mesh mesh = klein_bottle(64, 33);
  const Grid grid = grid_around(mesh, 30);
  EXPECT_TRUE(expect_sides(mesh, grid, kParity, in_bottle).sure);
  const SignReport flood = expect_sides(mesh, grid, kFlood, in_bottle);
  EXPECT_EQ(flood.method, SignMethod::flood);
  const SignReport report = expect_sides(mesh, grid, kAutomatic, in_bottle);
  EXPECT_TRUE(report.method == SignMethod::flood || report.method == SignMethod::parity) << report.why;
  expect_doubt(mesh, grid, kWinding);
}

// A cup that opens one way of six: a flood comes in there alone, and its walls are inside.
TEST(SheetCases, FloodOfACup) {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool up : {false, true}) {
      SCOPED_TRACE(std::to_string(axis) + (up ? " up" : " down"));
      const auto turned = [&](Vec3 p) { return axis == 0 ? Vec3{p.z, p.x, p.y} : axis == 1 ? Vec3{p.y, p.z, p.x} : p; };
      const auto wall = [&](Vec3 low, Vec3 high) {
        if (!up) std::tie(low.z, high.z) = std::pair(-high.z, -low.z);
        const Vec3 a = turned(low), b = turned(high);
        return box(min(a, b), max(a, b));
      };
      Mesh cup;
      std::vector<Convex> walls;
      for (const auto& [low, high] : {std::pair(Vec3{-1, -1, -1}, Vec3{1, 1, -0.6}),
                                      {{-1, -1, -0.7}, {-0.6, 1, 1}},
                                      {{0.6, -1, -0.7}, {1, 1, 1}},
                                      {{-0.7, -1, -0.7}, {0.7, -0.6, 1}},
                                      {{-0.7, 0.6, -0.7}, {0.7, 1, 1}}}) {
        walls.emplace_back(wall(low, high));
        cup = joined(std::move(cup), wall(low, high));
      }
      expect_sides(cup, grid_around(cup, 26), kFlood, [&](Vec3 p) { return in_any(walls, p); });
    }
}

// Nothing holds a flood off: all is outside, and that is no answer.
TEST(SheetCases, FloodsThatLeak) {
  for (const Mesh& mesh : {flat_square(), moebius()}) {
    const Grid grid = cube_about_origin(16, 1.4);
    const SignReport report = expect_sides(mesh, grid, kFlood, nowhere);
    EXPECT_EQ(report.method, SignMethod::flood);
    EXPECT_FALSE(report.sure);
    expect_doubt(mesh, grid, kFlood);
  }
}

// The chair of two-sided boards, welded or not. As it is oriented it has no inside; without one copy of each face it
// has, and a flood needs not even that.
class TwoSidedChair : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(SheetCases, TwoSidedChair, ::testing::Bool());

TEST_P(TwoSidedChair, IsItsBoards) {
  Mesh chair;
  std::vector<Convex> boards;
  const auto add = [&](Vec3 low, Vec3 high) {
    const Mesh board = box(low, high);
    boards.emplace_back(board);
    chair = joined(std::move(chair), two_sided(board, GetParam()));
  };
  add({0, 0, 1}, {1, 1, 1.2});
  add({0, 0.8, 1.25}, {1, 1, 2.5});
  for (const double x : {0.0, 0.8})
    for (const double y : {0.0, 0.8}) add({x, y, 0}, {x + 0.2, y + 0.2, 0.95});
  const auto in_boards = [&](Vec3 p) { return in_any(boards, p); };
  const Grid grid = grid_around(chair, 30);
  const SignReport report = expect_sides(chair, grid, kAutomatic, in_boards);
  EXPECT_NE(report.method, SignMethod::none) << report.why;
  EXPECT_GT(report.left_out, 0);
  expect_sides(chair, grid, kFlood, in_boards);
  for (unsigned seed = 0; seed < 3; ++seed) expect_sides(shuffled(chair, seed), grid, kAutomatic, in_boards);
}

// The volume of such a mesh is 0 but for rounding, which has either sign.
TEST(SheetCases, TwoSidedBalls) {
  for (std::uint32_t n = 4; n < 12; ++n)
    for (const bool welded : {false, true}) {
      SCOPED_TRACE(std::to_string(n) + (welded ? " welded" : ""));
      const Mesh ball = moved(sphere(n), {0.3, 0.2, 0.1}, 1.0 / n);
      const SignReport report = expect_sides(two_sided(ball, welded), grid_around(ball, 12), kAutomatic, Convex(ball));
      EXPECT_EQ(report.left_out, std::ssize(ball.triangles));
    }
}

// A slot that no grid line passes through lets nothing in. What lies within is inside as well.
TEST(SheetCases, FloodOfASoupWithASlot) {
  const Mesh outer = box({0, 0, 0}, {1, 1, 1});
  // The face z = 0 has triangles (0, 0), (0, 1), (1, 1) and (0, 0), (1, 1), (1, 0); the first is moved away from the
  // other.
  Mesh mesh = without(outer, 0);
  const double slot = 0.02;
  add_triangle(mesh, {0, slot, 0}, {0, 1, 0}, {1 - slot, 1, 0});
  const Vec3 middle{0.5, 0.5, 0.5};
  mesh = joined(joined(std::move(mesh), moved(sphere(5), middle, 0.2)), random_soup(7, 40, 0.3, 0.1, middle));
  std::int64_t turned = 0;
  mesh = randomly_turned(std::move(mesh), 9, turned);
  const Grid grid{{17, 17, 17}, {-0.31, -0.26, -0.283}, {0.1, 0.1, 0.1}};  // lines pass the slot by 0.03
  expect_sides(mesh, grid, kFlood, Convex(outer));
}

}  // namespace
}  // namespace standoff
