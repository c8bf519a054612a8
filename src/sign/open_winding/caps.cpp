// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/caps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/progress.h"
#include "geometry/predicates.h"
#include "sign/diagnosis/boundary.h"

namespace standoff {

// Rims.

namespace {

// A point amid the corners. Their weights are unequal, so that no symmetry of the corners puts samples on lines through
// it: solid angles are ill-conditioned at the edges of their triangles. Sums are relative to the first corner, for
// meshes far from the origin.
Vec3 point_amid(std::span<const Vec3> corners) {
  constexpr double kGolden = 0.6180339887498949;
  Vec3 sum;
  double weights = 0;
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const double golden = kGolden * static_cast<double>(n + 1), weight = 1 + 0.5 * (golden - std::floor(golden));
    sum = sum + (corners[n] - corners[0]) * weight;
    weights += weight;
  }
  return corners[0] + sum * (1 / weights);
}

constexpr std::size_t kArc = 8, kUncut = 32;  // edges

// The arcs that a polygon of so many corners is cut into.
std::size_t arcs_of(std::size_t size) { return (size + kArc - 1) / kArc; }

}  // namespace

void Rims::make(const Boundary& boundary, ProgressMeter& progress) {
  WorkCheck check(progress, 1 << 16);
  const auto for_each_checked = [&](const auto& use) {
    for_each_polygon(boundary, [&](BoundaryPolygon polygon) {
      check.add(static_cast<std::int64_t>(polygon.corners.size()));
      use(std::move(polygon));
    });
  };
  std::size_t rims = 0, corners = 0;
  for_each_checked([&](const BoundaryPolygon& polygon) {
    std::size_t size = polygon.corners.size();
    for (std::size_t most = kUncut; size > most; most = kMaxCorners) {
      rims += arcs_of(size);
      corners += size + 2 * arcs_of(size);
      size = 2 * arcs_of(size);
    }
    ++rims;
    corners += size;
  });
  corners_.reserve(corners);
  begin_.reserve(rims + 1);
  apexes_.reserve(rims);
  weights_.reserve(rims);
  for_each_checked([&](BoundaryPolygon polygon) { add(std::move(polygon.corners), polygon.weight); });
}

void Rims::add(std::vector<Vec3> polygon, std::int32_t weight) {
  for (std::size_t most = kUncut; polygon.size() > most; most = kMaxCorners) {
    const std::size_t size = polygon.size(), arcs = arcs_of(size);
    std::vector<Vec3> chords, arc;
    for (std::size_t n = 0; n < arcs; ++n) {
      arc.clear();
      for (std::size_t corner = n * size / arcs; corner <= (n + 1) * size / arcs; ++corner)
        arc.push_back(polygon[corner % size]);
      // Bend the chord: straight ones pass through samples where corners and samples share a lattice.
      const Vec3 middle = (arc.front() + (arc.back() - arc.front()) * 0.5), amid = point_amid(arc),
                 bend = middle + (amid - middle) * 0.3;
      chords.push_back(arc.front());
      chords.push_back(bend);
      arc.push_back(bend);
      add_small(arc, weight);
    }
    polygon = std::move(chords);
  }
  add_small(polygon, weight);
}

void Rims::add_small(std::span<const Vec3> polygon, std::int32_t weight) {
  apexes_.push_back(point_amid(polygon));
  weights_.push_back(weight);
  corners_.insert(corners_.end(), polygon.begin(), polygon.end());
  begin_.push_back(corners_.size());
}

Mesh caps_of(const Rims& rims) {
  std::size_t vertices = 0, triangles = 0;
  for (std::size_t n = 0; n < rims.size(); ++n) {
    vertices += rims[n].corners.size() + 1;
    triangles += rims[n].corners.size() * static_cast<std::size_t>(rims[n].weight);
  }
  Mesh mesh;
  mesh.vertices.reserve(vertices);
  mesh.triangles.reserve(triangles);
  for (std::size_t n = 0; n < rims.size(); ++n) {
    const Rim rim = rims[n];
    const auto apex = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(rim.apex);
    mesh.vertices.insert(mesh.vertices.end(), rim.corners.begin(), rim.corners.end());
    const auto size = static_cast<std::uint32_t>(rim.corners.size());
    for (std::int32_t copy = 0; copy < rim.weight; ++copy)
      for (std::uint32_t corner = 0; corner < size; ++corner)
        mesh.triangles.push_back({apex, apex + 1 + (corner + 1) % size, apex + 1 + corner});
  }
  return mesh;
}

// Angles of caps.

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
// Twice the error of the cross product n of two directions. A length above that is right within a factor of two, and
// n / |n|^2 is right within kDirectionError / |n|^2.
constexpr double kDirectionError = 4e-15;

// A sum of angles: the product of complex numbers that have these arguments, and the number of full turns.
class AngleSum {
 public:
  // Adds the argument of x + iy, in (-pi, pi].
  void add(double x, double y) {
    const double re = re_ * x - im_ * y, im = re_ * y + im_ * x;
    // Two angles of the upper half plane add up to [0, 2 pi]; beyond pi, the product is in the lower half plane.
    if (im_ >= 0 && y >= 0 && im < 0) ++full_turns_;
    if (im_ < 0 && y < 0 && im >= 0) --full_turns_;
    re_ = re;
    im_ = im;
  }
  // The sum in full turns.
  double turns() const { return full_turns_ + std::atan2(im_, re_) / (2 * std::numbers::pi); }

 private:
  double re_ = 1, im_ = 0;
  int full_turns_ = 0;
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

// The direction of the apex from p + (e^3, e, e^2), with an infinitely small e: it exists even if p is the apex.
Vec3 direction_of_apex(const Vec3& apex, const Vec3& p) {
  const Direction found = direction(p, apex);
  return found.length > 0 ? found.unit : Vec3{0, -1, 0};
}

// Half of the solid angle of (apex, corner, next) as the argument of x + iy, from directions and their dot products
// (van Oosterom and Strackee 1983).
struct HalfAngle {
  double x, y;
};
HalfAngle half_angle(const Vec3& apex, const Vec3& normal, double corner_next, double apex_next, double apex_corner,
                     const Vec3& apex_at, const Vec3& corner_at, const Vec3& next_at, const Vec3& p) {
  // Directions are rounded by some 1e-16: a larger y has the right sign. Where x is positive, the angle does not jump
  // with the sign of y.
  const double x = 1 + corner_next + apex_next + apex_corner;
  double y = dot(apex, normal);
  if (x < 0 && std::abs(y) < 1e-13)
    y = std::copysign(std::max(std::abs(y), 1e-30), side_of_plane(apex_at, next_at, corner_at, p));
  return {x, y};
}

// x and y are each off by at most 2e-15, and each multiplication adds 4e-16.
double rounding_of(double edges, double least_sq) {
  return edges * std::min(1.0, 1e-15 * (1 + 1 / std::sqrt(least_sq)));
}

// Sums up the angles of a cap's triangles. Calls use(corner, next, their cross product, their dot product) for each
// edge of the rim.
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
  if (side == 0) side = orient2d({a.z, a.x}, {b.z, b.x}, {c.z, c.x});  // the normal's y
  if (side == 0) side = orient2d({a.x, a.y}, {b.x, b.y}, {c.x, c.y});  // its z
  if (side == 0) side = orient2d({a.y, a.z}, {b.y, b.z}, {c.y, c.z});  // its x
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
  double rounded = 0;  // times kDirectionError, bounds the rounding of the gradient
  const auto add_edge = [&](const Direction& a, const Direction& b, const Vec3& normal, double cosine) {
    const double product = a.length * b.length, sum = a.length + b.length;
    const double edge = length(b.unit * b.length - a.unit * a.length), end = std::min(a.length, b.length);
    // Find the distance of the edge: the distance of its line if the foot is on the edge, else of an end. The triangle
    // inequality bounds it for short edges, because rounding hides their direction.
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
    // Compute 1 + cosine so that it does not cancel beside the middle of a long edge.
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
