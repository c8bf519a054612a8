// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
// Which triangles are on the surface of the union: against winding numbers by solid angles, and for solids whose union
// is known.
#include "standoff/exposed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "standoff/error.h"
#include "tests/sign/brute_winding.h"
#include "tests/sign/fine_box.h"
#include "tests/sign/shapes.h"
#include "tests/sign/solid_soup.h"

namespace standoff {
namespace {

using namespace testing;

constexpr SignOptions kAsItIs{.method = SignMethod::winding, .as_oriented = true};

std::vector<Exposure> classes(const Mesh& mesh, const SignOptions& sign = kAsItIs) {
  return exposed_triangles(mesh, {.sign = sign}).of;
}

bool counts_as_inside(int winding, WindingRule rule) {
  if (rule == WindingRule::odd) return winding % 2 != 0;
  return rule == WindingRule::nonzero ? winding != 0 : winding > 0;
}

// Whether solid angles find inside on both sides of a triangle, at a point of it.
bool is_internal_at(const Mesh& mesh, std::size_t triangle, const Vec3& shares, WindingRule rule) {
  const auto [a, b, c] = MeshView(mesh).corners(triangle);
  const Vec3 normal = cross(b - a, c - a), at = a * shares.x + b * shares.y + c * shares.z;
  const Vec3 off = normal * (1e-7 / length(normal));
  const auto inside = [&](const Vec3& p) {
    return counts_as_inside(static_cast<int>(std::lround(brute_winding(mesh, p).value)), rule);
  };
  return inside(at + off) && inside(at - off);
}

struct Compared {
  int exposed = 0, internal = 0, cut = 0, mixed = 0;
};

// Compares triangles at random points. Where these disagree with each other, the triangle must count as cut.
Compared compare(const Mesh& mesh, int triangles, unsigned seed, WindingRule rule = WindingRule::positive) {
  SignOptions sign = kAsItIs;
  sign.rule = rule;
  const std::vector<Exposure> found = classes(mesh, sign);
  Random random(seed);
  Compared compared;
  for (int n = 0; n < triangles; ++n) {
    const std::size_t t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
    int internal = 0;
    constexpr Vec3 kPoints[] = {{.34, .33, .33}, {.8, .11, .09}, {.07, .83, .1}, {.12, .09, .79}};
    for (const Vec3& shares : kPoints) internal += is_internal_at(mesh, t, shares, rule);
    compared.mixed += internal != 0 && internal != 4;
    switch (found[t]) {
      case Exposure::exposed:
        ++compared.exposed;
        EXPECT_EQ(internal, 0) << t;
        break;
      case Exposure::internal:
        ++compared.internal;
        EXPECT_EQ(internal, 4) << t;
        break;
      case Exposure::cut:
        ++compared.cut;
    }
  }
  return compared;
}

Mesh random_spheres(unsigned seed, int count, double radius) {
  Random random(seed);
  Mesh mesh;
  for (int n = 0; n < count; ++n)
    mesh = joined(mesh, moved(sphere(5), random.in_cube(0.5), radius * random.between(0.5, 1)));
  return mesh;
}

TEST(Exposed, PlainSolidsAreExposedAltogether) {
  for (const Mesh& mesh : {box(), sphere(), torus(), joined(sphere(), moved(sphere(), {5, 0, 0})),
                           joined(moved(sphere(), {}, 2), reversed(sphere()))}) {  // a cavity
    const ExposedTriangles found = exposed_triangles(mesh);
    EXPECT_EQ(found.internal, 0);
    EXPECT_EQ(found.cut, 0);
    EXPECT_EQ(found.of.size(), mesh.triangles.size());
    EXPECT_EQ(found.sign.method, SignMethod::winding);
  }
}

TEST(Exposed, ASolidInASolidIsInternalUnlessTheRuleSaysOtherwise) {
  const Mesh outer = moved(sphere(), {}, 2), mesh = joined(outer, moved(sphere(), {0.1, 0.2, 0.3}));
  const std::size_t first = outer.triangles.size();
  for (const WindingRule rule : {WindingRule::positive, WindingRule::nonzero, WindingRule::odd}) {
    SignOptions sign = kAsItIs;
    sign.rule = rule;
    const ExposedTriangles found = exposed_triangles(mesh, {.sign = sign});
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      EXPECT_EQ(found.of[t], t < first || rule == WindingRule::odd ? Exposure::exposed : Exposure::internal);
  }
}

TEST(Exposed, RandomSpheresAgainstSolidAngles) {
  const Mesh mesh = random_spheres(1, 100, 0.2);
  const Compared compared = compare(mesh, 300, 2);
  EXPECT_GT(compared.exposed, 20);
  EXPECT_GT(compared.internal, 30);
  EXPECT_GT(compared.cut, 50);
  EXPECT_GT(compared.mixed, 10);
  for (const WindingRule rule : {WindingRule::odd, WindingRule::nonzero})
    compare(random_spheres(3, 20, 0.3), 200, 4, rule);
}

TEST(Exposed, ATorusThroughItself) {
  // The tube is wider than the hole.
  const Compared compared = compare(torus(24, 12, 0.4, 0.6), 200, 5);
  EXPECT_GT(compared.exposed, 50);
  EXPECT_GT(compared.cut, 10);
}

TEST(Exposed, OverlappingTetrahedraOfIntegers) {
  // Corners on faces, edges on edges, faces in one plane.
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    std::vector<Tetrahedron> all = integer_tetrahedra(random, 4, 2);
    Mesh mesh;
    for (Tetrahedron& t : all) {
      const int side = orientation(t[0], t[1], t[2], t[3]);
      if (side == 0) continue;  // solid angles know no normal of a flat one
      if (side < 0) std::swap(t[0], t[1]);
      add_tetrahedron(mesh, t);
    }
    if (!mesh.triangles.empty()) compare(mesh, 12, seed);
  }
}

// Boxes side by side.
TEST(Exposed, AWallThatTwoBoxesShareIsInternalWhateverItsTriangles) {
  for (const std::uint32_t m : {1u, 2u, 3u})
    for (const std::uint32_t n : {1u, 2u, 4u})
      for (const bool other : {false, true}) {
        const Mesh left = fine_box({0, 0, 0}, {1, 1, 1}, m), right = fine_box({1, 0, 0}, {2, 1, 1}, n, other),
                   mesh = joined(left, right);
        const ExposedTriangles found = exposed_triangles(mesh, {.sign = kAsItIs});
        EXPECT_EQ(found.internal, 2 * (m * m + n * n)) << m << ' ' << n << ' ' << other;
        EXPECT_EQ(found.cut, 0);
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
          bool wall = true;
          for (const Vec3& v : MeshView(mesh).corners(t)) wall = wall && v.x == 1;
          EXPECT_EQ(found.of[t] == Exposure::internal, wall);
        }
      }
}

TEST(Exposed, ABoxOnALargerOne) {
  const Mesh base = fine_box({0, 0, 0}, {5, 5, 1}, 5), tower = fine_box({1.5, 1.5, 1}, {3.5, 3.5, 4}, 3);
  const ExposedTriangles found = exposed_triangles(joined(base, tower), {.sign = kAsItIs});
  // The tower's lower side is covered by 3 x 3 squares of the base, of which the middle one is covered by it.
  EXPECT_EQ(found.internal, 2 * 9 + 2);
  // Of the 16 triangles of the squares around that one, two in corners only touch the tower.
  EXPECT_EQ(found.cut, 14);
}

TEST(Exposed, WallsWithinRoundingOfEachOtherAreKept) {
  // Turned walls round differently: a gap, or an overlap, of one rounding. The small one covers the middles of the
  // large one's triangles, which are exposed around it.
  for (double angle = 0.1; angle < 1.5; angle += 0.1) {
    const auto turned = [&](Mesh mesh) {
      const double c = std::cos(angle), s = std::sin(angle);
      for (Vec3& v : mesh.vertices) v = {c * v.x - s * v.y + 0.1, s * v.x + c * v.y, v.z};
      return mesh;
    };
    const Mesh mesh = joined(turned(box()), turned(box({1, 0.25, 0.25}, {2, 0.75, 0.75})));
    const ExposedTriangles found = exposed_triangles(mesh, {.sign = kAsItIs});
    for (std::size_t t = 0; t < 12; ++t) EXPECT_NE(found.of[t], Exposure::internal) << angle << ' ' << t;
    // Walls with the same corners are the same, however they are turned.
    EXPECT_EQ(exposed_triangles(turned(joined(box(), box({1, 0, 0}, {2, 1, 1}))), {.sign = kAsItIs}).internal, 4);
  }
}

TEST(Exposed, TrianglesWithoutAreaAreWhatIsAroundThem) {
  Mesh inner = sphere();
  const auto [a, b, c] = inner.triangles[7];
  inner.triangles[7] = {a, b, c};
  // A triangle with a corner on an edge's middle: two triangles and one without an area in place of one.
  const auto middle = static_cast<std::uint32_t>(inner.vertices.size());
  inner.vertices.push_back((inner.vertices[a] + inner.vertices[b]) * 0.5);
  inner.triangles[7] = {a, middle, c};
  inner.triangles.push_back({middle, b, c});
  inner.triangles.push_back({a, b, middle});
  inner.triangles.push_back({a, a, b});
  const ExposedTriangles alone = exposed_triangles(inner, {.sign = kAsItIs});
  EXPECT_EQ(alone.internal, 0);
  const ExposedTriangles found = exposed_triangles(joined(inner, moved(sphere(), {}, 3)), {.sign = kAsItIs});
  EXPECT_EQ(found.internal, static_cast<std::int64_t>(inner.triangles.size()));
}

TEST(Exposed, CopiesThatAreLeftOutAreClassifiedToo) {
  const Mesh walls = joined(box({0, 0, 0}, {1, 1, 1}), box({1, 0, 0}, {2, 1, 1}));
  const ExposedTriangles found = exposed_triangles(walls);
  EXPECT_EQ(found.internal, 4);
  const Mesh copied = with_copy(joined(walls, box({-1, -1, -1}, {3, 3, 3})), 3, true);
  const ExposedTriangles inside = exposed_triangles(copied);
  EXPECT_EQ(inside.internal, 25);
  EXPECT_GT(inside.sign.left_out, 0);
}

TEST(Exposed, DoesNotDependOnTheThreadsOrTheOrder) {
  const Mesh mesh = random_spheres(6, 30, 0.3), other = shuffled(mesh, 7);
  const ExposedTriangles one = exposed_triangles(mesh, {.sign = kAsItIs, .execution = {.threads = 1}}),
                         three = exposed_triangles(mesh, {.sign = kAsItIs, .execution = {.threads = 3}}),
                         again = exposed_triangles(other);
  EXPECT_EQ(one.of, three.of);
  EXPECT_EQ(one.internal, again.internal);
  EXPECT_EQ(one.cut, again.cut);
}

TEST(Exposed, FarFromTheOriginAndScaled) {
  const Mesh mesh = random_spheres(8, 12, 0.4);
  const std::vector<Exposure> found = classes(mesh);
  EXPECT_EQ(classes(moved(mesh, {}, 0x1p-60)), found);
  EXPECT_EQ(classes(moved(mesh, {}, 0x1p40)), found);
}

TEST(Exposed, OpenMeshesAndOtherMethodsAreErrors) {
  const auto code = [](const Mesh& mesh, const SignOptions& sign) {
    try {
      exposed_triangles(mesh, {.sign = sign});
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode{};
  };
  EXPECT_EQ(code(without(sphere(), 3), kAsItIs), ErrorCode::input);
  EXPECT_EQ(code(terrain(), {.method = SignMethod::automatic}), ErrorCode::input);
  EXPECT_EQ(code(terrain(), {.method = SignMethod::winding}), ErrorCode::input);
  EXPECT_EQ(code(sphere(), {.method = SignMethod::flood}), ErrorCode::usage);
  EXPECT_EQ(code(sphere(), {SignMethod::none}), ErrorCode::usage);
  EXPECT_EQ(code(sphere(), {}), ErrorCode{}) << "automatic is the default";
}

}  // namespace
}  // namespace standoff
