// SPDX-License-Identifier: Apache-2.0
#include "points/sides_of_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "points/open_point_winding.h"
#include "points/ray_winding.h"
#include "points/winding_slope.h"
#include "sign/normal/pseudonormals.h"
#include "sign/rows/integer_winding.h"
#include "standoff/error.h"

namespace standoff {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The points that were decided last, to decide others; the oldest one makes room.
template <class Known>
class LastKnown {
 public:
  std::span<const Known> all() const { return std::span(known_).first(count_); }
  void add(const Known& one) {
    known_[next_] = one;
    next_ = (next_ + 1) % known_.size();
    count_ = std::max(count_, next_ == 0 ? known_.size() : next_);
  }

 private:
  std::array<Known, 8> known_;
  std::size_t count_ = 0, next_ = 0;
};

// A free radius is off by some 1e-16 of the coordinates; the margin is far above that.
double empty_radius(const PointToSide& p) { return p.free_radius - 1e-12 * (p.free_radius + max_norm(p.at)); }
// Whether a length whose square is given is less than another.
bool is_less(double sq, double than) { return than > 0 && sq < than * than * (1 - 1e-12); }

// The winding number of a closed mesh does not change where no triangle is. So points whose empty balls overlap have
// the same number. Of the other points, most have a ball of a point before on one of their rows: a segment up to there
// says by how much their numbers differ. Only the rest sends a ray.
class ClosedSides final : public SidesOfPoints {
 public:
  /// `all_near`: free radii are those of all triangles. Where hidden ones do not count, sides are the same within a
  /// ball, but numbers may differ.
  ClosedSides(const OrientedMesh& mesh, const TriangleIndex& index, WindingRule rule, bool all_near)
      : rays_(mesh, index), rule_(rule), all_near_(all_near) {}

  void decide(std::span<const PointToSide> points, const cpu::PointKernels& kernels,
              std::span<bool> inside) const override {
    LastKnown<Known> known;
    for (std::size_t n = 0; n < points.size(); ++n) {
      Known own{points[n].at, empty_radius(points[n]), 0};
      const auto same = std::ranges::find_if(known.all(), [&](const Known& other) { return overlap(own, other); });
      const bool is_new = same == known.all().end();
      own.winding = is_new ? winding_beside(own, known.all(), kernels) : same->winding;
      inside[n] = is_inside(own.winding, rule_);
      if (is_new || own.radius > same->radius) known.add(own);  // else the other one says more about others
    }
  }
  double winding_number(Vec3 point, const cpu::PointKernels& kernels) const override {
    return rays_.at(point, kernels);
  }

 private:
  struct Known {
    Vec3 at;
    double radius;  // of a ball without triangles; not positive if none is known
    std::int32_t winding;
  };
  static bool overlap(const Known& a, const Known& b) {
    const Vec3 between = a.at - b.at;
    return std::min(a.radius, b.radius) > 0 && is_less(dot(between, between), a.radius + b.radius);
  }
  // A point whose ball is on a row of another one, and how far along that row.
  struct OnRow {
    const Known* known = nullptr;
    int axis = 0;
    double length = kInfinity;
  };
  static void look_along_rows(const Known& point, const Known& other, OnRow& nearest) {
    const Vec3 between = other.at - point.at;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 off = turned(between, axis);
      if (std::abs(off.x) < nearest.length && is_less(off.y * off.y + off.z * off.z, other.radius))
        nearest = {&other, axis, std::abs(off.x)};
    }
  }
  // Of a point whose ball overlaps no other one.
  std::int32_t winding_beside(const Known& own, std::span<const Known> known, const cpu::PointKernels& kernels) const {
    OnRow nearest;
    if (all_near_)
      for (const Known& other : known) look_along_rows(own, other, nearest);
    if (!nearest.known) return rays_.at(own.at, kernels);
    const double there = turned(nearest.known->at, nearest.axis).x;
    return nearest.known->winding + rays_.beyond(nearest.axis, there, own.at, kernels);
  }

  RayWinding rays_;
  WindingRule rule_;
  bool all_near_;
};

// The winding number of an open mesh changes slowly where no triangle is, and on the way between points whose empty
// balls overlap is none. So two such points are on the same side of the thresholds, if they are no farther from each
// other than the slope allows for the distance from the nearest one.
class OpenSides final : public SidesOfPoints {
 public:
  /// `all_near`: as above.
  OpenSides(const OrientedMesh& mesh, const TriangleIndex& index, const Boundary& boundary, WindingRule rule,
            bool all_near, int threads, Simd simd)
      : winding_(mesh, index, boundary, threads, simd), slope_(boundary), rule_(rule), all_near_(all_near) {}

  void decide(std::span<const PointToSide> points, const cpu::PointKernels& kernels,
              std::span<bool> inside) const override {
    LastKnown<Known> known;
    for (std::size_t n = 0; n < points.size(); ++n) {
      const Vec3& at = points[n].at;
      const double radius = empty_radius(points[n]);
      const auto same = std::ranges::find_if(known.all(), [&](const Known& other) {
        return is_less(dot(at - other.at, at - other.at), std::min(other.reach, other.radius + radius));
      });
      if (same != known.all().end()) {
        inside[n] = same->inside;
        continue;
      }
      const OpenPointWinding::Side side = winding_.side(at, rule_, kernels);
      inside[n] = side.inside;
      if (all_near_ && radius > 0) known.add({at, radius, reach_of(at, radius, side.margin), side.inside});
    }
  }
  double winding_number(Vec3 point, const cpu::PointKernels& kernels) const override {
    return winding_.at(point, kernels);
  }
  std::int64_t memory_bytes() const override { return winding_.memory_bytes() + slope_.memory_bytes(); }

 private:
  struct Known {
    Vec3 at;
    double radius;  // of its empty ball
    double reach;   // nearer than that, the other side does not begin without a triangle on the way
    bool inside;
  };

  double reach_of(const Vec3& at, double radius, double margin) const {
    // Within balls that overlap; and only of its own, where the boundary is near.
    for (const double part : {4.0, 0.75}) {
      const double most = part * radius;
      const double slope = slope_.around(at, most, 16 * margin / most);
      if (slope * most <= margin) return most;
      if (slope < kInfinity) return margin / slope;
    }
    return 0;
  }

  OpenPointWinding winding_;
  WindingSlope slope_;
  WindingRule rule_;
  bool all_near_;
};

class NormalSidesOfPoints final : public SidesOfPoints {
 public:
  explicit NormalSidesOfPoints(const OrientedMesh& mesh)
      : normals_(mesh), bytes_(static_cast<std::int64_t>(150 * mesh.mesh.triangles.size())) {}

  void decide(std::span<const PointToSide> points, const cpu::PointKernels&, std::span<bool> inside) const override {
    for (std::size_t n = 0; n < points.size(); ++n)
      inside[n] = normals_.place_of(points[n].at, points[n].triangle) == Pseudonormals::Place::back;
  }
  std::int64_t memory_bytes() const override { return bytes_; }

 private:
  Pseudonormals normals_;
  std::int64_t bytes_;
};

}  // namespace

double SidesOfPoints::winding_number(Vec3, const cpu::PointKernels&) const {
  throw Error(ErrorCode::usage, "points: only a query whose sign method is winding knows winding numbers");
}

std::unique_ptr<SidesOfPoints> make_sides_of_points(const OrientedMesh& mesh, const TriangleIndex& index,
                                                    const SignPlan& plan, WindingRule rule, int threads, Simd simd) {
  switch (plan.report.method) {
    case SignMethod::winding:
      if (plan.boundary.edges.empty()) return std::make_unique<ClosedSides>(mesh, index, rule, plan.exposed.empty());
      return std::make_unique<OpenSides>(mesh, index, plan.boundary, rule, plan.exposed.empty(), threads, simd);
    case SignMethod::parity:
      return std::make_unique<ClosedSides>(mesh, index, WindingRule::odd, plan.exposed.empty());
    case SignMethod::normal:
      return std::make_unique<NormalSidesOfPoints>(mesh);
    default:
      return nullptr;
  }
}

}  // namespace standoff
