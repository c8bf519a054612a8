// SPDX-License-Identifier: Apache-2.0
// How long pairs of boxes stay apart when one of the two moves, and which pairs of triangles may meet, in double
// precision. docs/collision_methods.md derives the bounds. No operations are fused, so all sets give the same bits.
#pragma once

#include <cstdint>
#include <limits>

#include "collision/body/kernel_data.h"
#include "geometry/closest_pair.h"
#include "geometry/triangle_overlap.h"
#include "simd/points.inl"

namespace standoff::collision::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

namespace {

STANDOFF_INLINE DoublePoint same_points(const Vec3& at) {
  return {WideDouble(at.x), WideDouble(at.y), WideDouble(at.z)};
}
STANDOFF_INLINE DoublePoint load_eight(const float (&at)[3][kLanes], int first) {
  return {WideDouble::load(at[0] + first), WideDouble::load(at[1] + first), WideDouble::load(at[2] + first)};
}
STANDOFF_INLINE DoublePoint load_eight(const double (&at)[3][kLanes], int first) {
  return {WideDouble::load(at[0] + first), WideDouble::load(at[1] + first), WideDouble::load(at[2] + first)};
}
STANDOFF_INLINE WideDouble magnitude(const WideDouble& a) { return max(a, -a); }
STANDOFF_INLINE WideDouble length(const DoublePoint& v) { return sqrt(plain_dot(v, v)); }
/// A unit vector; zero for a vector without length.
STANDOFF_INLINE DoublePoint unit(const DoublePoint& v) {
  return v * (WideDouble(1) / max(length(v), WideDouble(std::numeric_limits<double>::min())));
}

struct EightObbs {
  DoublePoint center, axis[3];
  WideDouble half[3];
};
STANDOFF_INLINE EightObbs eight_of(const Obb16& boxes, int first) {
  EightObbs eight;
  eight.center = load_eight(boxes.center, first);
  for (int k = 0; k < 3; ++k) {
    eight.axis[k] = load_eight(boxes.axis[k], first);
    eight.half[k] = WideDouble::load(boxes.half[k] + first);
  }
  return eight;
}
STANDOFF_INLINE EightObbs eight_times(const DoubleObb& box) {
  EightObbs eight;
  eight.center = same_points(box.center);
  for (int k = 0; k < 3; ++k) {
    eight.axis[k] = same_points(box.axis[k]);
    eight.half[k] = WideDouble(box.half[k]);
  }
  return eight;
}

// A resting and a moving box in each lane.
class MovingBoxes {
 public:
  STANDOFF_INLINE MovingBoxes(const EightObbs& resting, const EightObbs& moving, const RigidVelocity& velocity,
                              double keep)
      : resting_(resting),
        moving_(moving),
        linear_(same_points(velocity.linear)),
        rotation_(same_points(velocity.rotation)),
        offset_(moving.center - resting.center),
        arm_(moving.center - same_points(velocity.center)),
        keep_(keep),
        rate_(velocity.rate),
        turning_(0),
        turns_(!(velocity.rotation == Vec3{})) {
    if (!turns_) return;
    WideDouble size_sq(0);
    for (const WideDouble& half : moving.half) size_sq = size_sq + half * half;
    // Axes in single precision may be longer than one: corners are farther from the center than the half diagonal.
    turning_ = length(plain_cross(rotation_, arm_)) + rate_ * sqrt(size_sq) * WideDouble(kAxisRoundUp);
  }

  STANDOFF_INLINE DoublePoint line_of_centers() const { return unit(offset_); }

  // How long a slab perpendicular to a unit vector keeps the boxes apart, at least. In the time s a point of the moving
  // box approaches by at most a s + b s^2 / 2, and by at most c s: a is the largest speed of such points towards the
  // resting box now, b bounds their acceleration, and c their speed at any time.
  STANDOFF_INLINE WideDouble free_time(const DoublePoint& axis) const {
    const WideDouble zero(0), two(2), never(std::numeric_limits<double>::infinity()), along = plain_dot(axis, offset_);
    const DoublePoint n = select(less(along, zero), axis * WideDouble(-1.0), axis);
    const WideDouble by_linear = -plain_dot(n, linear_);
    WideDouble gap = magnitude(along) - keep_;
    for (int k = 0; k < 3; ++k)
      gap = gap - resting_.half[k] * magnitude(plain_dot(n, resting_.axis[k])) -
            moving_.half[k] * magnitude(plain_dot(n, moving_.axis[k]));
    if (!turns_)  // b is 0, and all points have one speed
      return select(less(zero, gap), select(less(zero, by_linear), gap / by_linear, never), zero);
    const DoublePoint q = plain_cross(n, rotation_);
    WideDouble a = by_linear - plain_dot(q, arm_);
    for (int k = 0; k < 3; ++k) a = a + moving_.half[k] * magnitude(plain_dot(q, moving_.axis[k]));
    const WideDouble b = length(q) * turning_, c = by_linear + b / rate_;
    // Both forms of the root are the same number; each loses digits where the other does not.
    const auto approaches = less(zero, a);
    const WideDouble root = max(sqrt(a * a + two * b * max(gap, zero)), magnitude(a));
    const WideDouble by_acceleration = select(approaches, two * gap, root - a) / select(approaches, a + root, b);
    const WideDouble by_speed = select(less(zero, c), gap / c, never);
    // If b is 0, so is the part of a and c that comes from the rotation, and the speed alone decides.
    const WideDouble time = max(by_speed, select(less(zero, b), by_acceleration, zero));
    return select(less(zero, gap), time, zero);
  }

 private:
  EightObbs resting_, moving_;
  DoublePoint linear_, rotation_, offset_, arm_;
  WideDouble keep_, rate_, turning_;
  bool turns_;
};

void obb_free_times(const Obb16& boxes, const DoubleObb& box, bool sixteen_move, const RigidVelocity& velocity,
                    double keep, double enough, double* time) {
  const EightObbs same = eight_times(box);
  for (int first = 0; first < kLanes; first += WideDouble::kLanes) {
    const EightObbs eight = eight_of(boxes, first);
    const MovingBoxes pairs =
        sixteen_move ? MovingBoxes(same, eight, velocity, keep) : MovingBoxes(eight, same, velocity, keep);
    WideDouble longest = pairs.free_time(pairs.line_of_centers());
    const auto all_are_free = [&]() __attribute__((always_inline)) {
      return less(longest, WideDouble(enough)).to_bits() == 0;
    };
    for (int k = 0; k < 3 && !all_are_free(); ++k) longest = max(longest, pairs.free_time(same.axis[k]));
    for (int k = 0; k < 3 && !all_are_free(); ++k) longest = max(longest, pairs.free_time(eight.axis[k]));
    longest.store(time + first);
  }
}

// The axes are in lanes: those of both boxes and the line of centers, twice.
double obb_free_time(const DoubleObb& resting, const DoubleObb& moving, const RigidVelocity& velocity, double keep) {
  const MovingBoxes pair(eight_times(resting), eight_times(moving), velocity, keep);
  alignas(64) double line[3][WideDouble::kLanes], axes[3][WideDouble::kLanes], time[WideDouble::kLanes];
  store_points(pair.line_of_centers(), line);
  for (int j = 0; j < 3; ++j) {
    for (int k = 0; k < 3; ++k) axes[j][k] = resting.axis[k][j], axes[j][3 + k] = moving.axis[k][j];
    axes[j][6] = axes[j][7] = line[j][0];
  }
  pair.free_time(load_points(axes)).store(time);
  double longest = 0;
  for (const double one : time) longest = standoff::max(longest, one);
  return longest;
}

// Moving triangles in lanes, and what bounds their motion.
struct EightMoving {
  DoublePoint corner[3], velocity[3];
  WideDouble turning;  // of the corners: the length of rotation x (corner - center), at most
};
// The part of a line that triangles cover.
struct Covered {
  WideDouble low, high;
};
// What the moving triangles cover of the unit vector n during the duration; `across` is the length of n x rotation.
STANDOFF_INLINE Covered covered(const EightMoving& moving, const DoublePoint& n, const WideDouble& across,
                                const WideDouble& duration) {
  const WideDouble zero(0), bend = across * moving.turning * duration * duration * WideDouble(0.5);
  Covered all{WideDouble(0), WideDouble(0)};
  for (int k = 0; k < 3; ++k) {
    const WideDouble at = plain_dot(n, moving.corner[k]), way = plain_dot(n, moving.velocity[k]) * duration;
    const WideDouble low = at + min(zero, way - bend), high = at + max(zero, way + bend);
    all.low = k == 0 ? low : min(all.low, low);
    all.high = k == 0 ? high : max(all.high, high);
  }
  return all;
}
STANDOFF_INLINE Covered covered(const DoublePoint (&corner)[3], const DoublePoint& n) {
  const WideDouble at[3] = {plain_dot(n, corner[0]), plain_dot(n, corner[1]), plain_dot(n, corner[2])};
  return {min(at[0], min(at[1], at[2])), max(at[0], max(at[1], at[2]))};
}
STANDOFF_INLINE WideDouble gap_between(const Covered& a, const Covered& b) {
  return max(a.low - b.high, b.low - a.high);
}

struct alignas(64) DoublesOfLanes {
  double low[kLanes], high[kLanes];

  STANDOFF_INLINE Covered in_all_lanes(int n) const { return {WideDouble(low[n]), WideDouble(high[n])}; }
};

void approaching_triangles(const DoubleTriangles& resting, const DoubleTriangles& moving,
                           const DoubleTransform& to_resting, const RigidVelocity& velocity,
                           const Vec3 (&axes)[kLeafAxes], double keep_all, double lasts, std::uint32_t* moving_lanes) {
  constexpr int kEight = WideDouble::kLanes, kHalves = kLanes / kEight;
  const WideDouble keep(keep_all), duration(lasts);
  const DoublePoint rotation = same_points(velocity.rotation);
  EightMoving eight[kHalves];
  for (int half = 0; half < kHalves; ++half) {
    EightMoving& m = eight[half];
    m.turning = WideDouble(0);
    for (int k = 0; k < 3; ++k) {
      m.corner[k] = transformed(to_resting, load_eight(moving.corner[k], half * kEight));
      const DoublePoint turning = plain_cross(rotation, m.corner[k] - same_points(velocity.center));
      m.velocity[k] = same_points(velocity.linear) + turning;
      m.turning = max(m.turning, length(turning));
    }
  }
  for (int n = 0; n < kLanes; ++n) moving_lanes[n] = (1u << kLanes) - 1;
  const auto keep_near = [&](int n, int half, const WideDouble& gap) __attribute__((always_inline)) {
    moving_lanes[n] &= ~(less(keep, gap).to_bits() << (half * kEight));
  };
  for (int a = 0; a < kLeafAxes; ++a) {
    const DoublePoint axis = same_points(axes[a]);
    const WideDouble across = length(plain_cross(axis, rotation));
    DoublesOfLanes rests;
    for (int first = 0; first < kLanes; first += kEight) {
      DoublePoint corner[3];
      for (int k = 0; k < 3; ++k) corner[k] = load_eight(resting.corner[k], first);
      const Covered eight_rest = covered(corner, axis);
      eight_rest.low.store(rests.low + first), eight_rest.high.store(rests.high + first);
    }
    std::uint32_t any = 0;
    for (int half = 0; half < kHalves; ++half) {
      const Covered moves = covered(eight[half], axis, across, duration);
      for (int n = 0; n < kLanes; ++n) keep_near(n, half, gap_between(moves, rests.in_all_lanes(n)));
    }
    for (int n = 0; n < kLanes; ++n) any |= moving_lanes[n];
    if (any == 0) return;
  }
  DoublePoint normal[kHalves];
  Covered along_normal[kHalves];
  for (int half = 0; half < kHalves; ++half) {
    const EightMoving& m = eight[half];
    normal[half] = unit(plain_cross(m.corner[1] - m.corner[0], m.corner[2] - m.corner[0]));
    along_normal[half] = covered(m, normal[half], length(plain_cross(normal[half], rotation)), duration);
  }
  for (int n = 0; n < kLanes; ++n) {
    if (moving_lanes[n] == 0) continue;
    DoublePoint corner[3];
    for (int k = 0; k < 3; ++k)
      corner[k] = {WideDouble(resting.corner[k][0][n]), WideDouble(resting.corner[k][1][n]),
                   WideDouble(resting.corner[k][2][n])};
    const DoublePoint its_normal = unit(plain_cross(corner[1] - corner[0], corner[2] - corner[0]));
    const WideDouble across = length(plain_cross(its_normal, rotation));
    const Covered rests = covered(corner, its_normal);
    for (int half = 0; half < kHalves; ++half) {
      keep_near(n, half, gap_between(along_normal[half], covered(corner, normal[half])));
      keep_near(n, half, gap_between(covered(eight[half], its_normal, across, duration), rests));
    }
  }
}

}  // namespace
}  // namespace standoff::collision::STANDOFF_TARGET
