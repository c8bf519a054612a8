// SPDX-License-Identifier: Apache-2.0
// sweep() of one motion, against what is true at positions on the path, and of the whole path where it is straight.
#pragma once

#include "tests/collision/zoo/findings.h"
#include "tests/collision/zoo/placed_pair.h"
#include "tests/collision/zoo/swept_depth.h"
#include "tests/collision/zoo/tolerances.h"

namespace standoff::testing {

/// How deep b goes into a on a straight path.
inline double swept_depth(const PlacedBody& a, const PlacedBody& b, const Vec3& translation) {
  double deepest = -std::numeric_limits<double>::infinity();
  for (std::uint32_t t = 0; t < b.size(); ++t) {
    Box swept = b.box(t);
    swept.include(swept.min + translation), swept.include(swept.max + translation);
    for (std::uint32_t s = 0; s < a.size(); ++s) {
      const Vec3 out = max(a.box(s).min - swept.max, swept.min - a.box(s).max);
      if (std::max({out.x, out.y, out.z}) > 0) continue;
      deepest = std::max(deepest, swept_depth(b.triangle(t), translation, a.triangle(s)));
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
  } catch (const Error& error) {  // points, on paths on which rounding moves them by more than the tolerance
    const double far = length(apply(motion.end, motion.center) - apply(motion.start, motion.center));
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
  const Vec3 translation = motion.end.translation - motion.start.translation;
  const double allowed =
      at.allowed.on_path(length(translation), length(motion.start.translation) + length(at.pose_a.translation));
  // Before the time they are apart: at positions on the path.
  for (int k = 0; k < 5; ++k) {
    const double t = k == 0 ? meeting : k == 1 ? 1 : swept.time * random.between(0, 1);
    if (t > swept.time || (swept.hit && t == swept.time)) continue;
    const PlacedBody b(at.model_b.mesh(), pose_at(motion, t));
    found.expect(touching_pairs(at.a, b).empty(), "sweep: they touch before its time, or on a free path");
  }
  const bool straight = motion.start.rotation == motion.end.rotation;
  if (straight) {
    found.count("straight sweeps");
    found.off("sweep: how deep they get into each other before its time, or on a free path",
              swept_depth(at.a, at.b, translation * swept.time), allowed);
    // A check that saw nothing would pass everything: it has to see what the whole path leads through.
    if (swept.hit && swept.time > 0)
      found.count("straight sweeps whose whole path leads through", swept_depth(at.a, at.b, translation) > allowed);
  }
  if (!swept.hit) return;
  const Pose end = pose_at(motion, swept.time);
  const Corners p = at.a.triangle(swept.triangle_a), q = corners_at(at.model_b.mesh(), swept.triangle_b, end);
  found.off("sweep: beyond the tolerance at its time", gap(p, q) - tolerance, allowed);
  if (swept.time > 0) found.off("sweep: length of a normal", std::abs(length(swept.normal) - 1), kUnitLengthOff);
}

}  // namespace standoff::testing
