// SPDX-License-Identifier: Apache-2.0
// sweep() of one motion, against what is true at places on the way, and of the whole way where it is straight.
#pragma once

#include "tests/collision/zoo/findings.h"
#include "tests/collision/zoo/placed_pair.h"
#include "tests/collision/zoo/tolerances.h"
#include "tests/collision/zoo/way.h"

namespace standoff::testing {

/// How deep b goes into a on a straight way.
inline double depth_on_way(const PlacedBody& a, const PlacedBody& b, const Vec3& way) {
  double deepest = -std::numeric_limits<double>::infinity();
  for (std::uint32_t t = 0; t < b.size(); ++t) {
    Box swept = b.box(t);
    swept.include(swept.min + way), swept.include(swept.max + way);
    for (std::uint32_t s = 0; s < a.size(); ++s) {
      const Vec3 out = max(a.box(s).min - swept.max, swept.min - a.box(s).max);
      if (std::max({out.x, out.y, out.z}) > 0) continue;
      deepest = std::max(deepest, depth_on_way(b.triangle(t), way, a.triangle(s)));
    }
  }
  return deepest;
}

/// `at` is the start. `meeting` is a time at which they are likely to touch, if they ever do.
inline void check_sweep(const PlacedPair& at, const RigidMotion& motion, double tolerance, double meeting,
                        Random& random, Findings& found) {
  found.count("sweeps");
  SweepResult swept;
  try {
    swept = sweep(at.model_a, at.pose_a, at.model_b, motion, {tolerance});
  } catch (const Error& error) {  // points, on ways on which rounding moves them by more than the tolerance
    const double far = length(apply(motion.to, motion.center) - apply(motion.from, motion.center));
    found.count("sweeps refused, for their length");
    found.expect(error.code() == ErrorCode::usage && far > 2e15 * tolerance, "sweep: refused, but not that long");
    return;
  }
  found.count("sweeps that hit", swept.hit);
  found.expect(swept.time >= 0 && swept.time <= 1, "sweep: a time outside 0 to 1");
  if (at.touch()) {
    found.count("sweeps that touch at the start");
    found.expect(swept.hit && swept.time == 0, "sweep: no hit at the start, where they touch");
    return;
  }
  const Vec3 way = motion.to.translation - motion.from.translation;
  const double allowed =
      at.allowed.on_way(length(way), length(motion.from.translation) + length(at.pose_a.translation));
  // Before the time they are apart: at places on the way.
  for (int k = 0; k < 5; ++k) {
    const double t = k == 0 ? meeting : k == 1 ? 1 : swept.time * random.between(0, 1);
    if (t > swept.time || (swept.hit && t == swept.time)) continue;
    const PlacedBody b(at.model_b.mesh(), pose_at(motion, t));
    found.expect(touching_pairs(at.a, b).empty(), "sweep: they touch before its time, or on a free way");
  }
  const bool straight = motion.from.rotation == motion.to.rotation;
  if (straight) {
    found.count("straight sweeps");
    found.off("sweep: how deep they get into each other before its time, or on a free way",
              depth_on_way(at.a, at.b, way * swept.time), allowed);
    // A check that saw nothing would pass everything: it has to see what the whole way leads through.
    if (swept.hit && swept.time > 0)
      found.count("straight sweeps whose whole way leads through", depth_on_way(at.a, at.b, way) > allowed);
  }
  if (!swept.hit) return;
  const Pose end = pose_at(motion, swept.time);
  const Corners p = at.a.triangle(swept.triangle_a), q = corners_at(at.model_b.mesh(), swept.triangle_b, end);
  found.off("sweep: beyond the tolerance at its time", gap(p, q) - tolerance, allowed);
  if (swept.time > 0) found.off("sweep: length of a normal", std::abs(length(swept.normal) - 1), kUnitLengthOff);
}

}  // namespace standoff::testing
