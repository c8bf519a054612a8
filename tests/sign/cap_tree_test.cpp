// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/cap_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <memory>

#include "sign/diagnosis/closed.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/open_winding/caps.h"
#include "sign/open_winding/quick_angles.h"
#include "sign/rows/row_crossings.h"
#include "simd/dispatch.h"
#include "tests/sign/shapes.h"

namespace standoff {
namespace {

using namespace testing;

// What certifies the sides of open meshes: fields of caps are as near to the caps' angles as they say, caps close the
// mesh, and angles jump where rows cross.

Boundary polygon(std::span<const Vec3> corners, std::int32_t weight = 1) {
  Boundary boundary;
  for (std::size_t n = 0; n < corners.size(); ++n)
    boundary.edges.push_back({corners[n], corners[(n + 1) % corners.size()], weight});
  boundary.begin.push_back(boundary.edges.size());
  return boundary;
}

// Rims of a few corners at random places, and cells at all distances from them.
class RandomCaps {
 public:
  explicit RandomCaps(unsigned seed) : random_(seed) {
    Boundary boundary;
    const int count = 1 + static_cast<int>(random_.below(6));
    const double size = std::exp2(random_.between(-6, 1));
    for (int n = 0; n < count; ++n) {
      const Vec3 at = random_.in_cube(1);
      std::vector<Vec3> corners(3 + random_.below(7));
      for (Vec3& v : corners) v = at + random_.in_cube(size);
      const Boundary one = polygon(corners, 1 + static_cast<int>(random_.below(3)));
      boundary.edges.insert(boundary.edges.end(), one.edges.begin(), one.edges.end());
      boundary.begin.push_back(boundary.edges.size());
    }
    rims_ = std::make_unique<Rims>(boundary);
    tree_ = std::make_unique<RimTree>(*rims_);
  }

  Cell random_cell() {
    const double size = std::exp2(random_.between(-8, 0));
    const Vec3 half{size * random_.between(0.1, 1), size * random_.between(0.1, 1), size * random_.between(0.1, 1)};
    return {random_.in_cube(random_.below(2) == 0 ? 4 : 40), half, length(half)};
  }
  Vec3 random_point(const Cell& cell) {
    // Corners of the cell often: errors are largest there.
    const auto along = [&](double half) {
      return random_.below(2) == 0 ? random_.between(-half, half) : random_.below(2) == 0 ? half : -half;
    };
    return cell.center + Vec3{along(cell.half.x), along(cell.half.y), along(cell.half.z)};
  }
  const Moments& all() const { return tree_->nodes()[0].caps; }
  double sum(const Vec3& p) const {
    double angles = 0;
    for (std::size_t n = 0; n < rims_->size(); ++n) angles += cap_angle((*rims_)[n], p).value;
    return angles;
  }
  LinearField sum_in(const Cell& cell, double tolerance, double most) const {
    ProgressMeter nobody;
    WorkCheck unwatched(nobody, kLooks);
    return cap_sum_in(*rims_, *tree_, cell, tolerance, most, unwatched);
  }
  Rim random_rim() { return (*rims_)[random_.below(static_cast<std::uint32_t>(rims_->size()))]; }

 private:
  Random random_;
  std::unique_ptr<Rims> rims_;
  std::unique_ptr<RimTree> tree_;
};

// How many fields were known, and how much of its error the worst one took.
struct Known {
  int fields = 0, points = 0;
  double worst = 0;

  void add(double off, double error) { worst = std::max(worst, std::abs(off) / error); }
  // Bounds that are far too large would hold, and decide nothing.
  void expect_useful() const {
    EXPECT_GT(fields, 10000);
    EXPECT_GT(worst, 0.05);
    EXPECT_LE(worst, 1);
  }
};

TEST(FieldsOfCaps, FarOnesAreWithinTheirErrors) {
  Known known;
  for (unsigned seed = 0; seed < 20; ++seed) {
    RandomCaps caps(seed);
    for (int n = 0; n < 1500; ++n) {
      const Cell cell = caps.random_cell();
      LinearField field;
      field.center = cell.center;
      const double bound = bound_of_field(caps.all(), cell);
      const bool is_rough = n % 2 == 0;
      const FieldTolerance tolerance = is_rough ? FieldTolerance::of_groups(0.1) : FieldTolerance(kFieldTolerance);
      const bool is_known = add_far_field(caps.all(), cell, tolerance, field);
      known.fields += is_known;
      for (int m = 0; m < 3; ++m) {
        const Vec3 p = caps.random_point(cell);
        const double angles = caps.sum(p);
        EXPECT_LE(std::abs(angles), bound * (1 + 1e-9) + 1e-12);
        if (is_known) known.add(angles - field.at(p), field.error + 1e-12);
        if (const auto at_point = far_field_at(caps.all(), p, tolerance)) {
          known.add(angles - at_point->value, at_point->error + 1e-12);
          EXPECT_LE(at_point->error, is_rough ? 0.1 : kFieldTolerance);
          ++known.points;
        }
      }
      EXPECT_LE(field.error, is_rough ? std::numeric_limits<double>::infinity() : kFieldTolerance);
    }
  }
  known.expect_useful();
  EXPECT_GT(known.points, 10000);
}

TEST(FieldsOfCaps, NearOnesAreWithinTheirErrors) {
  Known known;
  for (unsigned seed = 20; seed < 40; ++seed) {
    RandomCaps caps(seed);
    for (int n = 0; n < 1500; ++n) {
      const Cell cell = caps.random_cell();
      const Rim rim = caps.random_rim();
      const LinearField field = cap_field(rim, cell);
      if (!(field.error < 0.4)) continue;
      ++known.fields;
      for (int m = 0; m < 3; ++m) {
        const Vec3 p = caps.random_point(cell);
        double off = cap_angle(rim, p).value - field.at(p);
        // Continued across the cap, the angle is another one by an integer.
        if (may_touch(rim, cell)) off = std::remainder(off, 1.0);
        known.add(off, field.error);
      }
    }
  }
  known.expect_useful();
}

// All caps at once, of cells where no edge is: continued across those that are in the cell.
TEST(FieldsOfCaps, SumsAreWithinTheirErrors) {
  Known known;
  for (unsigned seed = 40; seed < 60; ++seed) {
    RandomCaps caps(seed);
    for (int n = 0; n < 1500; ++n) {
      const Cell cell = caps.random_cell();
      const double tolerance = n % 2 == 0 ? kFieldTolerance : 1e-6;
      const LinearField field = caps.sum_in(cell, tolerance, 0.4);
      if (!(field.error <= 0.4)) continue;
      ++known.fields;
      EXPECT_NEAR(std::remainder(caps.sum(cell.center) - field.value, 1.0), 0, field.error + 1e-12);
      for (int m = 0; m < 3; ++m) {
        const Vec3 p = caps.random_point(cell);
        known.add(std::remainder(caps.sum(p) - field.at(p), 1.0), field.error + 1e-12);
      }
    }
  }
  known.expect_useful();
}

// Next to the middle of a long edge a gradient is the difference of large numbers.
TEST(FieldsOfCaps, RoundingBesideLongEdgesIsInTheError) {
  Random random(1);
  int usable = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 a = random.in_cube(1), b = random.in_cube(1), c = random.in_cube(1);
    const Rims rims(polygon(std::vector<Vec3>{a, b, c}));
    const double near = std::exp2(random.between(-40, -2));
    const Vec3 half = Vec3{1, 1, 1} * (near * random.between(0.01, 0.5));
    const Cell cell{a + (b - a) * random.between(0.1, 0.9) + random.in_cube(near), half, length(half)};
    const LinearField field = cap_field(rims[0], cell);
    if (!(field.error < 0.4)) continue;
    ++usable;
    for (const double side : {-1.0, 1.0}) {
      const Vec3 p = cell.center + half * side;
      const CapAngle angle = cap_angle(rims[0], p);
      EXPECT_LE(std::abs(std::remainder(angle.value - field.at(p), 1.0)), field.error + angle.error) << near;
    }
  }
  EXPECT_GT(usable, 2000);
}

// The caps with the opposite of the boundary's edges are closed.
void expect_closing(const Boundary& boundary) {
  Mesh mesh = caps_of(Rims(boundary));
  for (const BoundaryEdge& edge : boundary.edges)
    for (int copy = 0; copy < edge.weight; ++copy) add_triangle(mesh, {9, 8, 7}, edge.from, edge.to);
  EXPECT_TRUE(is_closed(mesh).oriented);
}

TEST(Rims, CloseTheBoundary) {
  for (const Mesh& mesh : {random_soup(1, 30, 1, 1), nasty_soup(2, 60, 3), terrain(60), moebius(), klein_bottle()})
    expect_closing(net_boundary({mesh}, MeshEdges(mesh)));
  std::vector<Vec3> circle(1000);
  for (std::size_t n = 0; n < circle.size(); ++n)
    circle[n] = {std::cos(kTurn * double(n) / 1000), std::sin(kTurn * double(n) / 1000), 0};
  expect_closing(polygon(circle, 2));
  const Rims rims(polygon(circle));
  for (std::size_t n = 0; n < rims.size(); ++n) EXPECT_LE(rims[n].corners.size(), Rims::kMaxCorners);
}

TEST(Rims, LoopsThatShareAnEdgeKeepTheirWeights) {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{0, 0, 1};
  Boundary shared;
  shared.edges = {{b, c, 1}, {c, a, 1}, {a, b, 4}, {b, d, 3}, {d, a, 3}};
  shared.begin.push_back(shared.edges.size());
  expect_closing(shared);
}

TEST(Rims, LoopsThatTouchAreTakenApart) {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{-1, 0, 0}, e{0, -1, 0};
  Boundary eight = polygon(std::array{a, b, c});
  for (const BoundaryEdge& edge : polygon(std::array{a, d, e}, 3).edges) eight.edges.push_back(edge);
  eight.begin.back() = eight.edges.size();
  const Rims rims(eight);
  ASSERT_EQ(rims.size(), 2u);
  EXPECT_EQ(rims[0].corners.size(), 3u);
  EXPECT_EQ(rims[0].weight + rims[1].weight, 4);
}

// On integers, where samples are on caps' planes, edges and corners: along a row the sum of crossings and angles may
// only change as fast as the angle of the rim, which is continuous but at its edges.
TEST(CapAngle, JumpsWhereRowsCross) {
  const ProgressCallback none;
  ProgressMeter progress(none);
  Random random(4);
  int jumps = 0;
  for (int n = 0; n < 300; ++n) {
    std::vector<Vec3> corners(4);
    const double z = random.below(5);
    // Flat caps in the planes of samples, and tilted ones.
    const double tilt = random.below(3);
    for (std::size_t corner = 0; corner < 4; ++corner) {
      constexpr double kX[] = {-9, 9, 9, -9}, kY[] = {-9, -9, 9, 9};
      corners[corner] = {kX[corner], kY[corner], z - 2 + tilt * kX[corner] / 9 * double(random.below(2))};
    }
    if (random.below(2) == 0) std::ranges::reverse(corners);
    for (Vec3& v : corners)
      v = n % 3 == 0 ? Vec3{v.x, v.y, v.z} : n % 3 == 1 ? Vec3{v.y, v.z, v.x} : Vec3{v.z, v.x, v.y};
    const Rims rims(polygon(corners));
    const Mesh caps = caps_of(rims);
    const Grid grid{{7, 7, 7}, {-3, -3, -3}};
    const RowCrossings crossings({caps}, grid, progress);
    for (std::int64_t k = 0; k < 7; ++k)
      for (std::int64_t j = 0; j < 7; ++j) {
        double last = 0;
        std::int32_t integer = 0;
        for (std::int64_t i = 0; i < 7; ++i) {
          for (const RowCrossing& one : crossings.of_tiles(0, 0))
            if (one.row() == j + 8 * k && one.past() == i) {
              integer += one.step();
              jumps += i > 0;
            }
          double winding = integer;
          for (std::size_t rim = 0; rim < rims.size(); ++rim)
            winding += cap_angle(rims[rim], grid.position(i, j, k)).value;
          EXPECT_LT(i == 0 ? 0 : std::abs(winding - last), 0.2);
          last = winding;
        }
      }
  }
  EXPECT_GT(jumps, 1000);
}

// Solid angles of many caps in float are within the error that they come with: far from caps, near them, in their
// planes and at their corners; for each instruction set the same.

class Caps {
 public:
  explicit Caps(const Mesh& mesh)
      : rims_(net_boundary({mesh}, MeshEdges(mesh))), tree_(rims_), quick_(rims_, tree_, nobody_) {}

  // Returns the error at the last of these tolerances.
  double expect_within_error(const Vec3& p, std::initializer_list<double> tolerances) {
    WorkCheck unwatched(nobody_, kLooks);
    NodeStack stack(tree_, unwatched);
    const Interval exact = cap_sum_at(rims_, tree_, p, 0, stack);
    PointSum sum(quick_, stack);
    // Some caps are summed up before.
    const Cell cell{p + Vec3{0.01, 0.02, -0.01}, {0.02, 0.02, 0.02}, 0.035};
    for (const bool whole : {false, true}) {
      LinearField others;
      others.center = cell.center;
      const NodeStack::Part nodes =
          whole ? stack.root() : stack.add_far(stack.root(), cell, kFieldTolerance, 0.01, others);
      if (!sum.begin(p, nodes, {others.at(p), others.error})) return -1;
      for (const double tolerance : tolerances) {
        const Interval found = sum.refine(tolerance);
        EXPECT_LE(std::abs(found.value - exact.value), found.error + exact.error)
            << p.x << ' ' << p.y << ' ' << p.z << ", tolerance " << tolerance;
        if (whole && tolerance == *(tolerances.end() - 1)) return found.error;
      }
    }
    return -1;
  }
  const Rims& rims() const { return rims_; }

 private:
  ProgressMeter nobody_;
  Rims rims_;
  RimTree tree_;
  QuickAngles quick_;
};

// Points of a triangle, of its edges, its corners and of their surroundings, at many distances.
template <class Use>
void for_each_point_near(const std::array<Vec3, 3>& t, Random& random, const Use& use) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const Vec3 places[] = {t[0], t[0] + (t[1] - t[0]) * 0.37, t[0] + (t[1] - t[0]) * 0.3 + (t[2] - t[0]) * 0.4,
                         t[0] + (t[1] - t[0]) * 1.2, t[0] + (t[2] - t[0]) * 0.5 - (t[1] - t[0]) * 0.1};
  for (const Vec3& place : places)
    for (double far = 1e-17; far < 2; far *= 10) {
      use(place + normal * (far / length(normal)));
      use(place - normal * (far / length(normal)));
      use(place + random.in_cube(far));
    }
}

TEST(PointSum, IsWithinItsError) {
  Random random(1);
  Mesh holes = sphere(24);
  std::erase_if(holes.triangles, [&](const Triangle& t) { return (t[0] + t[1]) % 5 == 0; });
  Mesh weighted = random_soup(3, 60, 1, 0.3);
  for (int n = 0; n < 40; ++n) weighted.triangles.push_back(weighted.triangles[random.below(30)]);
  for (const Mesh& mesh :
       {random_soup(1, 400, 1, 0.2), random_soup(2, 60, 1, 1), random_soup(4, 300, 1e-7, 1, {5, 6, 7}),
        moved(random_soup(5, 300, 1, 0.01), {1e6, -2e6, 3e6}), holes, weighted, terrain()}) {
    Caps caps(mesh);
    const Box box = bounds(mesh);
    double largest = 0, sum = 0;
    int points = 0;
    for (const double tolerance : {1e-5, 0.0}) {
      for (int n = 0; n < 100; ++n) {
        const Vec3 p = box.center() + random.in_cube(1.2) * box.longest_side();
        const double error = caps.expect_within_error(p, {1e-2, 1e-3, tolerance});
        ASSERT_GE(error, 0);
        largest = std::max(largest, error);
        sum += error;
        ++points;
      }
      for (int n = 0; n < 5; ++n)
        for_each_point_near(MeshView(mesh).corners(random.below(static_cast<std::uint32_t>(mesh.triangles.size()))),
                            random, [&](const Vec3& p) {
                              caps.expect_within_error(p, {1e-3, tolerance});
                            });
    }
    EXPECT_LT(sum / points, 2e-3);  // and the error is worth something
    EXPECT_LT(largest, 0.05);
  }
}

TEST(PointSum, PointsTooFarHaveNone) {
  Caps caps(random_soup(1, 100, 1, 0.2));
  EXPECT_LT(caps.expect_within_error({1e7, 0, 0}, {1e-3}), 0);
  EXPECT_GE(caps.expect_within_error({1e5, 0, 0}, {1e-3}), 0);
}

TEST(SolidAngles, AreTheSameForAllInstructionSets) {
  const Mesh mesh = random_soup(6, 64, 1, 0.5);
  std::array<std::array<std::vector<float>, 3>, 3> corners;
  for (std::size_t t = 0; t < 64; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 v = mesh.vertices[mesh.triangles[t][k]];
      corners[k][0].push_back(static_cast<float>(v.x));
      corners[k][1].push_back(static_cast<float>(v.y));
      corners[k][2].push_back(static_cast<float>(v.z));
    }
  cpu::AngleTriangles triangles;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corners[k][axis].resize(64 + cpu::AngleTriangles::kLanes);
      triangles.corner[k][axis] = corners[k][axis].data();
    }
  Random random(7);
  for (int n = 0; n < 200; ++n) {
    const Vec3 at = random.in_cube(1);
    const float p[3] = {static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)};
    const auto found = [&](Simd simd) {
      cpu::AngleSums sums = cpu::AngleSums::none();
      cpu::AngleChunk chunk;
      dispatch_of<cpu::SignKernels>()
          .of(simd, "sign")
          .add_solid_angles(triangles, 3, 50 + n % 11, p, 0.02f, sums, chunk);
      std::vector<float> all(sums.re, sums.re + 16);
      all.insert(all.end(), sums.im, sums.im + 16);
      all.insert(all.end(), sums.around, sums.around + 16);
      all.insert(all.end(), chunk.left, chunk.left + chunk.left_count);
      all.insert(all.end(), {chunk.least_length, chunk.least_sq});
      return all;
    };
    EXPECT_EQ(found(Simd::automatic), found(Simd::portable));
  }
}

// Rims without extent in one place: the radius of their common node is 0, but it is no leaf. It was once taken for one,
// and read rim -1.
TEST(CapTree, RimsWithoutExtentInOnePlace) {
  const Vec3 at{0.25, 0.5, 0.75};
  const std::array<Vec3, 3> corners{at, at, at};
  const Rims rims(polygon(corners));
  ASSERT_GT(rims.size(), 1u);
  const RimTree tree(rims);
  ProgressMeter nobody;
  WorkCheck check(nobody, 1);
  NodeStack stack(tree, check);
  LinearField far;
  far.center = at;
  const NodeStack::Part near = stack.add_far(stack.root(), {at, {}, 0}, 0, 0, far);
  EXPECT_EQ(near.end - near.begin, rims.size());
  EXPECT_EQ(cap_sum_at(rims, tree, at, 0, stack).value, 0);
}

}  // namespace
}  // namespace standoff
