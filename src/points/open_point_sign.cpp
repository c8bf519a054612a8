// SPDX-License-Identifier: Apache-2.0
#include "points/open_point_sign.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "core/threads.h"
#include "points/point_sign.h"
#include "sign/open_winding/caps.h"
#include "sign/signs.h"

namespace standoff {
namespace {

// A sum of fields is not worth being made finer, as for samples.
constexpr double kFinest = 1e-9;
// How many triangles are added up in the time of a boundary's edge: measured, and arbitrary within a factor of two.
constexpr std::size_t kTrianglesOfEdge = 4;

// The leaves among the node and all below it whose fields are not known to `tolerance`; the other fields are added.
void add_far(const RimTree& tree, std::int32_t number, const Cell& cell, double tolerance, LinearField& far,
             std::vector<std::int32_t>& near, WorkCheck& check) {
  check.add(1);
  const RimTree::Node& node = tree[number];
  if (add_far_field(node.caps, cell, tolerance, far)) return;
  if (node.is_leaf()) return near.push_back(number);
  add_far(tree, number + 1, cell, tolerance, far, near, check);
  add_far(tree, node.right, cell, tolerance, far, near, check);
}

}  // namespace

OpenPointWinding::OpenPointWinding(const OrientedMesh& mesh, const TriangleIndex& index, const Boundary& boundary,
                                   int threads, Simd simd)
    : oriented_(mesh),
      index_(index),
      triangles_cost_less_(mesh.mesh.triangles.size() < kTrianglesOfEdge * boundary.edges.size()),
      mesh_(mesh, index),
      rims_(boundary),
      tree_(rims_),
      caps_(caps_of(rims_)),
      cap_index_(std::make_unique<TriangleIndex>(caps_, std::span<const std::uint32_t>{}, threads, simd)) {}

std::int32_t OpenPointWinding::closed(Vec3 point, const cpu::PointKernels& kernels) const {
  // Closed are only both together: one way for both.
  const RayWay way = mesh_.shortest(point);
  return mesh_.at(point, way, kernels) + RayWinding({caps_}, *cap_index_).at(point, way, kernels);
}

Interval OpenPointWinding::cap_sum(Vec3 point, double tolerance, WorkCheck& check) const {
  const KeptByThread<std::vector<std::int32_t>> near;
  near->clear();
  LinearField far;
  far.center = point;
  if (!tree_.nodes().empty()) add_far(tree_, 0, {point, {}, 0}, tolerance, far, *near, check);
  Interval sum{far.value, far.error};
  for (const std::int32_t leaf : *near) {
    check.add(1);
    const CapAngle angle = cap_angle(rims_[static_cast<std::size_t>(tree_[leaf].rim)], point);
    sum.value += angle.value;
    sum.error += angle.error;
  }
  return sum;
}

std::optional<double> OpenPointWinding::sum_of_triangles(Vec3 point, const cpu::PointKernels& kernels) const {
  cpu::SolidAngles angles;
  angles.scale = index_.scale_at(point);
  const Vec3 at = point * angles.scale;
  angles.at[0] = at.x, angles.at[1] = at.y, angles.at[2] = at.z, angles.at[3] = 0;
  kernels.add_solid_angles(index_.tree(), oriented_.use.empty() ? nullptr : oriented_.use.data(), angles);
  if (!angles.is_certain) return {};
  double sum = 0;
  for (int n = 0; n < cpu::SolidAngles::kCount; ++n)
    sum += angles.around[n] + std::atan2(angles.im[n], angles.re[n]) / (2 * std::numbers::pi);
  for (int n = 0; n < angles.flat_count; ++n) {
    const std::array<Vec3, 3> t = oriented_.corners(angles.flat[n]);
    sum += 0.5 * side_of_plane(t[0], t[2], t[1], point);  // 1 on the inner side, where the corners turn clockwise
  }
  return sum;
}

double OpenPointWinding::at(Vec3 point, const cpu::PointKernels& kernels, WorkCheck& check) const {
  if (triangles_cost_less_) {
    check.add(static_cast<std::int64_t>(oriented_.mesh.triangles.size() / kTrianglesOfEdge));
    if (const std::optional<double> sum = sum_of_triangles(point, kernels)) return *sum;
  }
  return closed(point, kernels) + cap_sum(point, 0, check).value;
}

template <class Closed>
bool OpenPointWinding::side(Vec3 point, WindingRule rule, double most, const Closed& closed_of,
                            WorkCheck& check) const {
  for (double tolerance = kFieldTolerance;;) {
    const Interval angles = cap_sum(point, tolerance, check);
    const double winding = closed_of(angles.value) + angles.value, off = angles.error + kWindingRounding,
                 allowed = std::min(margin(winding, rule), most);
    if (tolerance == 0 || off < allowed) return is_inside(winding, rule);
    // Errors are sums of many: about as much smaller as each of them, and never quite.
    tolerance = tolerance > kFinest ? tolerance * std::clamp(allowed / off / 2, 1.0 / 64, 1.0 / 16) : 0;
  }
}

bool OpenPointWinding::side(Vec3 point, WindingRule rule, const cpu::PointKernels& kernels, WorkCheck& check) const {
  const std::int32_t whole = closed(point, kernels);
  return side(
      point, rule, std::numeric_limits<double>::infinity(), [&](double) { return whole; }, check);
}

bool OpenPointWinding::side(Vec3 point, WindingRule rule, const Interval& about, WorkCheck& check) const {
  // The whole part is right if both errors together are below 1/2.
  return side(
      point, rule, 0.49 - about.error, [&](double angles) { return std::round(about.value - angles); }, check);
}

LinearField OpenPointWinding::field(const Cell& cell, double tolerance, double most, WorkCheck& check) const {
  return cap_sum_in(rims_, tree_, cell, tolerance, most, check);
}

std::int64_t OpenPointWinding::memory_bytes() const {
  return cap_index_->memory_bytes() + static_cast<std::int64_t>(caps_.triangles.size() * 2 * sizeof(Triangle)) +
         static_cast<std::int64_t>(tree_.nodes().size() * sizeof(RimTree::Node));
}

namespace {

// A cell's function must say the winding number but for so much: two of them together, less than half.
constexpr double kUsable = 0.2;
// Fewer points are decided one by one.
constexpr std::size_t kFewCells = 4;

}  // namespace

// The points of one call. Those that are decided together, in a cell, are the numbers in `some`.
class OpenSides::Points {
 public:
  // What the points of one call after the other take.
  struct Memory {
    std::vector<std::uint32_t> some, high;
    std::vector<std::int32_t> windings;
  };

  Points(const OpenSides& sides, std::span<const PointToSide> points, const cpu::PointKernels& kernels,
         WorkCheck& check, std::span<bool> inside, Memory& memory)
      : winding_(sides.winding_),
        rule_(sides.rule_),
        points_(points),
        kernels_(kernels),
        check_(check),
        inside_(inside),
        memory_(memory) {}

  using Some = std::span<std::uint32_t>;

  void decide_all() {
    memory_.windings.resize(points_.size());
    memory_.some.resize(points_.size());
    std::iota(memory_.some.begin(), memory_.some.end(), 0u);
    decide(memory_.some);
  }

 private:
  // In cells that the boundary is far enough from.
  void decide(Some some) {
    if (some.size() < kFewCells) {
      for (const std::uint32_t n : some) inside_[n] = winding_.side(points_[n].at, rule_, kernels_, check_);
      return;
    }
    const Cell cell = cell_around(some);
    const LinearField field = winding_.field(cell, kFieldTolerance, kUsable, check_);
    if (!(field.error <= kUsable)) {
      const auto [low, high] = halves(some, cell);
      decide(low);
      return decide(high);
    }
    count(some, field.center);
    decide_by(field, some);
  }

  // The whole numbers in a cell without boundary: they continue that of the center, where they are those of mesh and
  // caps. All rows between points of the cell are in it.
  void count(Some some, const Vec3& center) {
    KnownWindings known(winding_.mesh(), kernels_);
    known.in_ball(center, 0, [&](const Vec3& at) { return winding_.closed(at, kernels_); });
    for (const std::uint32_t n : some) {
      const auto by_rows = [&](const Vec3& at) { return known.by_rows(at); };
      memory_.windings[n] = known.in_ball(points_[n].at, points_[n].free_radius,
                                          [&](const Vec3& at) { return known.on_row(at, by_rows); });
    }
  }

  // Of those whose whole numbers are known, as the function continues them.
  void decide_by(const LinearField& field, Some some) {
    std::size_t undecided = 0;
    for (const std::uint32_t n : some) {
      const double winding = memory_.windings[n] + field.at(points_[n].at);
      inside_[n] = is_inside(winding, rule_);
      if (!(margin(winding, rule_) > field.error + kWindingRounding)) some[undecided++] = n;
    }
    refine(field, some.first(undecided));
  }

  // Those that the function of a cell left undecided, by those of its parts.
  void refine(const LinearField& coarse, Some some) {
    if (some.empty()) return;
    const auto [low, high] = halves(some, cell_around(some));
    decide_part(coarse, low);
    decide_part(coarse, high);
  }

  void decide_part(const LinearField& coarse, Some some) {
    if (some.size() < kFewCells) {
      for (const std::uint32_t n : some) {
        const Vec3& at = points_[n].at;
        inside_[n] = winding_.side(at, rule_, {memory_.windings[n] + coarse.at(at), coarse.error}, check_);
      }
      return;
    }
    const Cell cell = cell_around(some);
    const LinearField field = winding_.field(cell, std::min(kFieldTolerance, coarse.error / 64), coarse.error, check_);
    if (!(field.error <= coarse.error)) return refine(coarse, some);
    // Both are the same winding number but for a whole one.
    const auto between = static_cast<std::int32_t>(std::round(coarse.at(cell.center) - field.value));
    for (const std::uint32_t n : some) memory_.windings[n] += between;
    decide_by(field, some);
  }

  Cell cell_around(Some some) const {
    Box box;
    for (const std::uint32_t n : some) box.include(points_[n].at);
    const double rounding = 1e-15 * std::max(max_norm(box.min), max_norm(box.max));
    const Vec3 half = box.extent() * 0.5 + Vec3{rounding, rounding, rounding};
    return {box.min + box.extent() * 0.5, half, length(half)};
  }

  struct Halves {
    Some low, high;
  };
  // Cut across the longest side of their cell, their order kept.
  Halves halves(Some some, const Cell& cell) const {
    const Vec3& e = cell.half;
    double Vec3::*const axis = e.x >= e.y && e.x >= e.z ? &Vec3::x : e.y >= e.z ? &Vec3::y : &Vec3::z;
    memory_.high.clear();
    std::size_t count = 0;
    for (const std::uint32_t n : some)
      if (points_[n].at.*axis < cell.center.*axis)
        some[count++] = n;
      else
        memory_.high.push_back(n);
    std::ranges::copy(memory_.high, some.begin() + static_cast<std::ptrdiff_t>(count));
    if (count == 0 || count == some.size()) count = some.size() / 2;  // all in one place
    return {some.first(count), some.subspan(count)};
  }

  const OpenPointWinding& winding_;
  const WindingRule rule_;
  const std::span<const PointToSide> points_;
  const cpu::PointKernels& kernels_;
  WorkCheck& check_;
  const std::span<bool> inside_;
  Memory& memory_;
};

void OpenSides::decide(std::span<const PointToSide> points, const cpu::PointKernels& kernels, WorkCheck& check,
                       std::span<bool> inside) const {
  const KeptByThread<Points::Memory> memory;
  Points(*this, points, kernels, check, inside, *memory).decide_all();
}

}  // namespace standoff
