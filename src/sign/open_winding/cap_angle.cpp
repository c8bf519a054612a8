// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/cap_angle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/predicates.h"

namespace standoff {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
// Twice what the cross product of two directions is off by. A length above that is right within a factor of two, and
// n / |n|^2 within kDirectionError / |n|^2.
constexpr double kDirectionError = 4e-15;

// A sum of angles, as the product of complex numbers that have these arguments, and how often it went around.
class AngleSum {
 public:
  /// Adds the argument of x + iy, from (-pi, pi].
  void add(double x, double y) {
    const double re = re_ * x - im_ * y, im = re_ * y + im_ * x;
    // Two angles of the upper half plane sum up to [0, 2 pi]: beyond pi, the product is in the lower one.
    if (im_ >= 0 && y >= 0 && im < 0) ++around_;
    if (im_ < 0 && y < 0 && im >= 0) --around_;
    re_ = re;
    im_ = im;
  }
  /// In full turns.
  double turns() const { return around_ + std::atan2(im_, re_) / (2 * std::numbers::pi); }

 private:
  double re_ = 1, im_ = 0;
  int around_ = 0;
};

struct Direction {
  Vec3 unit;
  double length;
};

Direction direction(const Vec3& from, const Vec3& to) {
  const Vec3 d = to - from;
  const double l = length(d);
  return {l > 0 ? d * (1 / l) : Vec3{}, l};
}

// That of the apex from p + (e^3, e, e^2), e infinitely small: it has one where p is the apex, too.
Vec3 direction_of_apex(const Vec3& apex, const Vec3& p) {
  const Direction found = direction(p, apex);
  return found.length > 0 ? found.unit : Vec3{0, -1, 0};
}

// Half of the solid angle of (apex, corner, next) as the argument of x + iy, from directions and their dot products
// [Van Oosterom and Strackee 1983].
struct HalfAngle {
  double x, y;
};
HalfAngle half_angle(const Vec3& apex, const Vec3& normal, double corner_next, double apex_next, double apex_corner,
                     const Vec3& apex_at, const Vec3& corner_at, const Vec3& next_at, const Vec3& p) {
  // Directions are rounded by some 1e-16: beyond that y has the right sign. Where x is positive, the angle does not
  // jump with it.
  const double x = 1 + corner_next + apex_next + apex_corner;
  double y = dot(apex, normal);
  if (x < 0 && std::abs(y) < 1e-13)
    y = std::copysign(std::max(std::abs(y), 1e-30), side_of_plane(apex_at, next_at, corner_at, p));
  return {x, y};
}

// x and y are each within 2e-15 of the exact ones, and multiplying adds 4e-16 per edge.
double rounding_of(double edges, double least_sq) {
  return edges * std::min(1.0, 1e-15 * (1 + 1 / std::sqrt(least_sq)));
}

// The angles of a cap's triangles. use(corner, next, cross product, dot product of the two) for each edge of the rim.
template <class Use>
CapAngle sum_angles(const Rim& rim, const Vec3& p, const Use& use) {
  const Vec3 apex = direction_of_apex(rim.apex, p);
  AngleSum sum;
  double least_sq = kUnbounded;
  Direction corner = direction(p, rim.corners.back());
  double apex_corner = dot(apex, corner.unit);
  const Vec3* corner_at = &rim.corners.back();
  for (const Vec3& next_at : rim.corners) {
    const Direction next = direction(p, next_at);
    const double apex_next = dot(apex, next.unit), corner_next = dot(corner.unit, next.unit);
    const Vec3 normal = cross(corner.unit, next.unit);
    const auto [x, y] = half_angle(apex, normal, corner_next, apex_next, apex_corner, rim.apex, *corner_at, next_at, p);
    sum.add(x, y);
    least_sq = std::min(least_sq, x * x + y * y);
    use(corner, next, normal, corner_next);
    corner = next;
    corner_at = &next_at;
    apex_corner = apex_next;
  }
  return {rim.weight * sum.turns(), rim.weight * rounding_of(static_cast<double>(rim.corners.size()), least_sq)};
}

}  // namespace

int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  int side = orient3d(a, b, c, p);
  if (side == 0) side = orient2d({a.z, a.x}, {b.z, b.x}, {c.z, c.x});  // of the normal's y
  if (side == 0) side = orient2d({a.x, a.y}, {b.x, b.y}, {c.x, c.y});  // of its z
  if (side == 0) side = orient2d({a.y, a.z}, {b.y, b.z}, {c.y, c.z});  // of its x
  return side;
}

CapAngle cap_angle(const Rim& rim, const Vec3& p) {
  return sum_angles(rim, p, [](const auto&...) {});
}

CapAngle edge_angle(const Rim& rim, std::size_t edge, const Vec3& p) {
  const Vec3 &corner_at = rim.corners[edge], &next_at = rim.corners[(edge + 1) % rim.corners.size()];
  const Vec3 apex = direction_of_apex(rim.apex, p), corner = direction(p, corner_at).unit,
             next = direction(p, next_at).unit;
  const auto [x, y] = half_angle(apex, cross(corner, next), dot(corner, next), dot(apex, next), dot(apex, corner),
                                 rim.apex, corner_at, next_at, p);
  AngleSum sum;
  sum.add(x, y);
  return {rim.weight * sum.turns(), rim.weight * rounding_of(1, x * x + y * y)};
}

LinearField cap_field(const Rim& rim, const Cell& cell) {
  Vec3 gradient;
  double bend = 0;     // bounds the second derivatives
  double rounded = 0;  // and this, times kDirectionError, the rounding of the gradient
  const auto add_edge = [&](const Direction& a, const Direction& b, const Vec3& normal, double cosine) {
    const double product = a.length * b.length, sum = a.length + b.length;
    const double edge = length(b.unit * b.length - a.unit * a.length), end = std::min(a.length, b.length);
    // The distance of the edge: of its line if the foot is on the edge, else of an end. Short edges are left to the
    // triangle inequality, because rounding hides their direction.
    double nearest = end;
    if (edge < 1e-6 * end) {
      nearest = end - edge;
    } else if (b.length * cosine < a.length && a.length * cosine < b.length) {
      nearest = product * (length(normal) - kDirectionError) / edge;
    }
    const double d = nearest * (1 - 1e-6) - cell.radius;
    if (!(d > 0)) {
      bend = kUnbounded;
      return;
    }
    // 1 + cosine, also where that would cancel: beside the middle of a long edge.
    const double both = cosine < 0 ? dot(normal, normal) / (1 - cosine) : 1 + cosine, factor = sum / (product * both);
    gradient = gradient + normal * factor;
    rounded += 2 * factor;
    bend += 2 / (d * d) * std::min(edge / d, 2.0);
  };
  const CapAngle angle = sum_angles(rim, cell.center, add_edge);
  if (bend == kUnbounded) return {cell.center, angle.value, {}, kUnbounded};
  const double scale = rim.weight / (4 * std::numbers::pi);
  return {cell.center, angle.value, gradient * scale,
          angle.error + scale * cell.radius * (bend * cell.radius / 2 + kDirectionError * rounded)};
}

}  // namespace standoff
