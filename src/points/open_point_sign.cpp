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

// Below this tolerance, an exact sum of all caps is as cheap as a finer sum of fields.
constexpr double kFinest = 1e-9;
// This many triangles are added up in the time of one boundary edge: measured, and arbitrary within a factor of two.
constexpr std::size_t kTrianglesOfEdge = 4;

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
  // Only mesh and caps together are closed, so both need the same ray.
  const RayDirection direction = mesh_.shortest(point);
  return mesh_.at(point, direction, kernels) + RayWinding({caps_}, *cap_index_).at(point, direction, kernels);
}

Interval OpenPointWinding::cap_sum(Vec3 point, double tolerance, WorkCheck& check) const {
  NodeStack stack(tree_, check);
  return cap_sum_at(rims_, tree_, point, tolerance, stack);
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
    sum += 0.5 * side_of_plane(t[0], t[2], t[1], point);  // 1 on the inner side, which sees the corners clockwise
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
bool OpenPointWinding::is_inside(Vec3 point, WindingRule rule, double most, const Closed& closed_of,
                                 WorkCheck& check) const {
  for (double tolerance = kFieldTolerance;;) {
    const Interval angles = cap_sum(point, tolerance, check);
    const double winding = closed_of(angles.value) + angles.value, off = angles.error + kWindingRounding,
                 allowed = std::min(margin(winding, rule), most);
    if (tolerance == 0 || off < allowed) return standoff::is_inside(winding, rule);
    // The error is the sum of many. It shrinks almost in proportion to the tolerance: aim at half of the allowed error.
    tolerance = tolerance > kFinest ? tolerance * std::clamp(allowed / off / 2, 1.0 / 64, 1.0 / 16) : 0;
  }
}

bool OpenPointWinding::is_inside(Vec3 point, WindingRule rule, const cpu::PointKernels& kernels,
                                 WorkCheck& check) const {
  const std::int32_t whole = closed(point, kernels);
  return is_inside(
      point, rule, std::numeric_limits<double>::infinity(), [&](double) { return whole; }, check);
}

bool OpenPointWinding::is_inside(Vec3 point, WindingRule rule, const Interval& about, WorkCheck& check) const {
  // The whole part is right if both errors together are below 1/2.
  return is_inside(
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

// The largest error of a cell's function: the errors of two functions must add up to less than 1/2.
constexpr double kUsable = 0.2;
// Fewer points than this are decided one by one.
constexpr std::size_t kFewPointsOfCell = 4;

}  // namespace

// The points of one call. `Some` lists the points that are decided together, in a cell, by their indices.
class OpenPointSigns::Points {
 public:
  // The memory that calls share.
  struct Memory {
    std::vector<std::uint32_t> some, high;
    std::vector<std::int32_t> windings;
  };

  Points(const OpenPointSigns& sides, std::span<const PointToSign> points, const cpu::PointKernels& kernels,
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
  // Halves the points until the boundary is far enough from their cell.
  void decide(Some some) {
    if (some.size() < kFewPointsOfCell) {
      for (const std::uint32_t n : some) inside_[n] = winding_.is_inside(points_[n].at, rule_, kernels_, check_);
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

  // Finds the whole numbers in a cell that the boundary does not reach. At the center it is the number of mesh and
  // caps; the other points continue it like the number of a closed mesh, as all rows between points of the cell lie in
  // it.
  void count(Some some, const Vec3& center) {
    WindingCache cache(winding_.mesh(), kernels_);
    cache.in_ball(center, 0, [&](const Vec3& at) { return winding_.closed(at, kernels_); });
    for (const std::uint32_t n : some) {
      const auto by_rows = [&](const Vec3& at) { return cache.by_rows(at); };
      memory_.windings[n] = cache.in_ball(points_[n].at, points_[n].free_radius,
                                          [&](const Vec3& at) { return cache.on_row(at, by_rows); });
    }
  }

  // Decides points whose whole numbers are known, by the function of their cell; refines where its error hides the
  // sign.
  void decide_by(const LinearField& field, Some some) {
    std::size_t undecided = 0;
    for (const std::uint32_t n : some) {
      const double winding = memory_.windings[n] + field.at(points_[n].at);
      inside_[n] = is_inside(winding, rule_);
      if (!(margin(winding, rule_) > field.error + kWindingRounding)) some[undecided++] = n;
    }
    refine(field, some.first(undecided));
  }

  // Decides the points that the function of a cell left open, by the functions of its halves.
  void refine(const LinearField& coarse, Some some) {
    if (some.empty()) return;
    const auto [low, high] = halves(some, cell_around(some));
    decide_part(coarse, low);
    decide_part(coarse, high);
  }

  void decide_part(const LinearField& coarse, Some some) {
    if (some.size() < kFewPointsOfCell) {
      for (const std::uint32_t n : some) {
        const Vec3& at = points_[n].at;
        inside_[n] = winding_.is_inside(at, rule_, {memory_.windings[n] + coarse.at(at), coarse.error}, check_);
      }
      return;
    }
    const Cell cell = cell_around(some);
    const LinearField field = winding_.field(cell, std::min(kFieldTolerance, coarse.error / 64), coarse.error, check_);
    if (!(field.error <= coarse.error)) return refine(coarse, some);
    // Both functions describe the same winding number up to a whole number.
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
  // Halves the points across the longest side of their cell, and keeps their order.
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
    if (count == 0 || count == some.size()) count = some.size() / 2;  // all points are in one place
    return {some.first(count), some.subspan(count)};
  }

  const OpenPointWinding& winding_;
  const WindingRule rule_;
  const std::span<const PointToSign> points_;
  const cpu::PointKernels& kernels_;
  WorkCheck& check_;
  const std::span<bool> inside_;
  Memory& memory_;
};

void OpenPointSigns::decide(std::span<const PointToSign> points, const cpu::PointKernels& kernels, WorkCheck& check,
                            std::span<bool> inside) const {
  const KeptByThread<Points::Memory> memory;
  Points(*this, points, kernels, check, inside, *memory).decide_all();
}

}  // namespace standoff
