// SPDX-License-Identifier: Apache-2.0
// The constants of collision queries that decide what rounding may do and when a search gives up, in one place: unit,
// typical value, and what breaks when they change. Shared by the CPU and by GPUs.
#pragma once

#include "geometry/rounding.h"
#include "standoff/pose.h"

namespace standoff::collision {

/// Factors that carry a number in single precision past its own rounding: a conversion from double and some ten
/// operations, 2^-24 (6e-8) each. Nearer to 1, a bound may end up on the wrong side of what it bounds; farther from 1,
/// queries look at pairs that they need not look at. Numbers, and not 1 + gamma_float(12): that is another float, and
/// with it other pairs would be looked at, and other steps of sweeps taken.
inline constexpr float kRoundUp = 1.000001f, kRoundDown = 1 - 1e-6f;
static_assert(kRoundUp - 1 > gamma_float(12) && 1 - kRoundDown > gamma_float(12));

/// What placing a bounding sphere and looking it up in a field may be off by, relative to the coordinates that this
/// goes through (QueryPair::reach): 14 operations in single precision are 8e-7, the spheres' own rounding as much
/// again. Smaller: touching bodies count as free. Larger: more pairs are tested exactly.
inline constexpr double kSinglePrecisionSlack = 2e-6;
static_assert(kSinglePrecisionSlack > 2 * gamma_float(14));
/// The same in double precision, relative to coordinates in the world: some 40 operations of 2^-53 (1.1e-16).
inline constexpr double kDoublePrecisionSlack = 1e-14;
static_assert(kDoublePrecisionSlack > gamma_double(40));
/// What the bounds of pairs of oriented boxes may be off by, relative to the radii of both bodies: along an axis 44
/// roundings of them, along three perpendicular ones the root of three times that. Smaller: a nearer pair may be
/// missed. Larger: more nodes are opened.
inline constexpr double kNodePairSlack = 5e-6;
static_assert(kNodePairSlack > 1.7320509 * gamma_float(44));
/// The same for triangles of two leaves: relative to the radii of both bodies, for corners that were rounded, and to
/// those of both leaves, for their projections.
inline constexpr double kCornerSlack = 2e-7, kLeafSlack = 1.1e-6;
static_assert(kCornerSlack > 3 * gamma_float(1) && kLeafSlack > 1.7320509 * gamma_float(10));
/// And relative to the distance that is compared with: 9 roundings along an axis.
inline constexpr double kFarShare = 2e-6;
static_assert(kFarShare > 1.7320509 * gamma_float(9));
/// What the gap between two bodies along a direction may be off by, in double precision, relative to the extent of what
/// is projected.
inline constexpr double kGapRounding = 8 * kRoundoffDouble;

/// Rotations whose rows are off by less than this are taken as they are: kDoublePrecisionSlack covers it. Others
/// are made orthonormal first.
inline constexpr double kOrthonormal = 4e-15;

/// What the transpose of a pose's matrix, taken for its inverse, may place a point of a body off by, relative to the
/// body's size: entries of the matrix times its transpose are off by kRigidTolerance, so their spectral norm by three
/// times that, and a corner of the box is sqrt(3) radii away; the rest is for the rounding of samples to single
/// precision. Smaller: a side may be wrong. Larger: more rays are followed.
inline constexpr double kInverseSlack = 1e-5;
static_assert(kInverseSlack > 3 * 1.8 * kRigidTolerance + 8 * kRoundoffFloat);
/// A factor that carries a length past what such a matrix lengthens it by.
inline constexpr double kRigidRoundUp = 1 + 2e-6;
static_assert(kRigidRoundUp * kRigidRoundUp > 1 + 3 * kRigidTolerance);

/// The automatic tolerance of a sweep, relative to the smaller and to the larger body. Larger: sweeps are faster and
/// report hits where bodies pass each other. Powers of two: scaling both bodies by one scales it exactly.
inline constexpr double kSweepTolerance = 0x1p-15, kLeastSweepTolerance = 0x1p-40;
/// A pose at some time goes through 12 roundings of its coordinates, a corner in it through 4 more: bodies jump by this
/// from one time to the next, relative to the coordinates. Smaller: a sweep misses what touches at a rounded pose.
inline constexpr double kPoseRounding = 16 * kRoundoffDouble;
/// Times near 1 are rounded by 1e-16; so much time may be lost in an addition, times two for safety. Smaller: bodies on
/// motions 1e10 times their size jump past each other.
inline constexpr double kTimeRounding = 4e-16;
/// Points of two triangles that are nearer than this share of a sweep's tolerance have no direction to rely on.
inline constexpr double kSureDirection = 1e-3;

/// A time after the end of every motion, which is 1: never.
inline constexpr double kNever = 2;

// What follows costs or saves time and changes no answer's meaning. Measured on the pairs of script/bench collision.

/// A bounding sphere is advanced as long as its steps are longer than this share of its radius: shorter ones cost more
/// than asking its sixteen children.
inline constexpr float kWorthwhileStep = 0.5f;
/// The sphere of a triangle has no children: it stops at this share of the fine field's spacing.
inline constexpr float kWorthwhileTriangleStep = 0.25f;
/// A triangle that has stopped looks this many field spacings ahead for triangles of the target.
inline constexpr double kLookAhead = 1.0;

}  // namespace standoff::collision
