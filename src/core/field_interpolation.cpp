// SPDX-License-Identifier: Apache-2.0
// Values and gradients between the samples.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/field_error.h"
#include "core/grid_axis.h"
#include "core/guarded.h"
#include "core/threads.h"
#include "standoff/field.h"

namespace standoff {
namespace {

// The cell that holds a point, along one axis: its first sample, and the point's place in it, 0 to 1.
struct AxisCell {
  std::int64_t first = 0;
  std::int64_t second = 0;
  double t = 0;
};

// A point that lies beyond the border by at most this share of a spacing counts as on it: coordinates that are computed
// in single precision, or from the other end of the grid, have a smaller error.
constexpr double kOnBorder = 1e-3;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Of the whole grid: so a point has the same place among the samples in every window.
double samples_from_origin(double point, const GridAxis& axis) { return (point - axis.origin) / axis.spacing; }

bool is_on_axis(double point, const GridAxis& axis) {
  const double at = samples_from_origin(point, axis), first = static_cast<double>(axis.first);
  return at >= first - kOnBorder && at <= first + static_cast<double>(axis.size - 1) + kOnBorder;
}

bool is_on_grid(const Grid& g, Vec3 p) {
  return is_on_axis(p.x, axis_of(g, 0)) && is_on_axis(p.y, axis_of(g, 1)) && is_on_axis(p.z, axis_of(g, 2));
}

bool answers_at(const Grid& g, Vec3 p, Outside outside) { return outside != Outside::nan || is_on_grid(g, p); }

// Of a point p outside the grid's box, where q is the nearest point of the box: a mesh in the box is at least
// sqrt(|p - q|^2 + d^2) away, where d is its distance from q, for the angle at q is never acute. The interpolation
// exceeds d by at most half the diagonal of a cell: a sample's value exceeds d by no more than its distance from q, and
// the mean square of that, weighted as the samples are, is at most a quarter of the diagonal's.
struct Bound {
  Vec3 way;      // from q to p
  double least;  // of d
  // Not hypot, which asks for a newer C library than all else does (docs/python_packaging.md): a field's values are
  // floats, whose squares doubles hold.
  double value() const { return std::sqrt(dot(way, way) + least * least); }
};

Bound bound_at(const DistanceField& field, Vec3 p, double interpolated) {
  const Grid& g = field.grid();
  const Box box = g.bounds();
  Vec3 q, diagonal;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    q[axis] = std::clamp(p[axis], box.min[axis], box.max[axis]);
    diagonal[axis] = g.size[axis] > 1 ? g.spacing[axis] : 0;
  }
  return {p - q, std::max(0.0, interpolated - length(diagonal) / 2)};
}

AxisCell axis_cell(double point, const GridAxis& axis) {
  if (axis.size == 1) return {};
  const std::int64_t last = axis.first + axis.size - 1;
  const double at =
      std::clamp(samples_from_origin(point, axis), static_cast<double>(axis.first), static_cast<double>(last));
  const auto cell = std::min(static_cast<std::int64_t>(at), last - 1);
  return {cell - axis.first, cell + 1 - axis.first, at - static_cast<double>(cell)};
}

struct CellOfPoint {
  AxisCell x, y, z;
  std::array<double, 8> corner{};  // x fastest
};

void expect_numbers(Vec3 p) {
  if (std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z))
    fail_field([] { return "the point to look at is not a number; give three numbers"; });
}

CellOfPoint cell_at(const DistanceField& field, Vec3 p) {
  const Grid& g = field.grid();
  CellOfPoint cell{axis_cell(p.x, axis_of(g, 0)), axis_cell(p.y, axis_of(g, 1)), axis_cell(p.z, axis_of(g, 2))};
  int n = 0;
  for (const auto k : {cell.z.first, cell.z.second})
    for (const auto j : {cell.y.first, cell.y.second})
      for (const auto i : {cell.x.first, cell.x.second}) cell.corner[n++] = field.value(i, j, k);
  return cell;
}

// If an end has a share in the result and is infinite, the result is infinite, never NaN.
double mix(double a, double b, double t) {
  if (a == b || t == 0) return a;
  return std::isinf(a) ? a : a + (b - a) * t;
}

// Sets out[n] = at(points[n]), by many threads.
template <class T, class At>
void for_all_points(std::span<const Vec3> points, std::span<T> out, const Execution& execution, At at) {
  validate("field", execution, Runs::on_the_cpu);
  if (points.size() != out.size())
    fail_field([=] {
      return std::to_string(points.size()) + " points have no room in " + std::to_string(out.size()) +
             " results; give room for one each";
    });
  constexpr std::size_t kAtOnce = 1024;  // points of a task: some tens of microseconds
  Threads(execution.threads).run([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), kAtOnce), [&](const auto& part) {
      for (std::size_t n = part.begin(); n < part.end(); ++n) out[n] = at(points[n]);
    });
  });
}

}  // namespace

void DistanceField::interpolate(std::span<const Vec3> points, std::span<double> out, const Execution& execution,
                                Outside outside) const try {
  for_all_points(points, out, execution, [=, this](Vec3 point) { return interpolate(point, outside); });
} catch (...) {
  throw_as_error("field");
}

void DistanceField::gradient(std::span<const Vec3> points, std::span<Vec3> out, const Execution& execution,
                             Outside outside) const try {
  for_all_points(points, out, execution, [=, this](Vec3 point) { return gradient(point, outside); });
} catch (...) {
  throw_as_error("field");
}

double DistanceField::interpolate(Vec3 point, Outside outside) const {
  expect_numbers(point);
  if (!answers_at(grid_, point, outside)) return kNan;
  const CellOfPoint cell = cell_at(*this, point);
  const auto& c = cell.corner;
  const auto row = [&](int n) { return mix(c[n], c[n + 1], cell.x.t); };
  const double value = mix(mix(row(0), row(2), cell.y.t), mix(row(4), row(6), cell.y.t), cell.z.t);
  if (outside != Outside::bound || is_on_grid(grid_, point)) return value;
  return bound_at(*this, point, value).value();
}

Vec3 DistanceField::gradient(Vec3 point, Outside outside) const {
  expect_numbers(point);
  if (!answers_at(grid_, point, outside)) return {kNan, kNan, kNan};
  const CellOfPoint cell = cell_at(*this, point);
  const auto& c = cell.corner;
  const double tx = cell.x.t, ty = cell.y.t, tz = cell.z.t;
  // Interpolate the difference along one axis bilinearly along the two others; `step` is the axis's stride in c.
  const auto slope = [&](int step, int u, double tu, int v, double tv) {
    const auto difference = [&](int n) { return c[n + step] == c[n] ? 0.0 : c[n + step] - c[n]; };
    return mix(mix(difference(0), difference(u), tu), mix(difference(v), difference(u + v), tu), tv);
  };
  const Vec3 inside = Vec3{slope(1, 2, ty, 4, tz), slope(2, 1, tx, 4, tz), slope(4, 1, tx, 2, ty)} / grid_.spacing;
  if (outside != Outside::bound || is_on_grid(grid_, point)) return inside;
  const Bound bound = bound_at(*this, point, interpolate(point, Outside::border));
  if (std::isinf(bound.least)) return inside;
  // The nearest point of the grid stays where it is along the axes on which the point is outside.
  Vec3 slope_of_bound;
  for (std::size_t axis = 0; axis < 3; ++axis)
    slope_of_bound[axis] = bound.way[axis] != 0 ? bound.way[axis] : bound.least * inside[axis];
  return slope_of_bound * (1 / bound.value());
}

}  // namespace standoff
