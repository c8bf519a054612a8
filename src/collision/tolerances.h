// SPDX-License-Identifier: Apache-2.0
// The constants of collision queries that bound rounding and end searches: unit, typical value, and what breaks when
// they change. The CPU and GPUs share them.
#pragma once

#include <cstdint>

#include "geometry/rounding.h"
#include "standoff/pose.h"

namespace standoff::collision {

/// Factors that make a number in single precision a bound in spite of its rounding: a conversion from double and some
/// ten operations, 2^-24 (6e-8) each. Nearer to 1: a bound may be wrong. Farther from 1: queries test pairs for
/// nothing. They are plain numbers because 1 + gamma_float(12) is another float: with it, queries would test other
/// pairs, and sweeps take other steps.
inline constexpr float kRoundUp = 1.000001f, kRoundDown = 1 - 1e-6f;
static_assert(kRoundUp - 1 > gamma_float(12) && 1 - kRoundDown > gamma_float(12));

/// The error of placing a bounding sphere and sampling a field there, relative to the largest coordinate on the way: 14
/// operations in single precision are 8e-7, and the rounding of the spheres themselves as much again. Smaller: touching
/// bodies count as free. Larger: more pairs are tested exactly.
inline constexpr double kSinglePrecisionSlack = 2e-6;
static_assert(kSinglePrecisionSlack > 2 * gamma_float(14));
/// The same in double precision, relative to coordinates in the world: some 40 operations of 2^-53 (1.1e-16).
inline constexpr double kDoublePrecisionSlack = 1e-14;
static_assert(kDoublePrecisionSlack > gamma_double(40));
/// The error of the bounds of pairs of oriented boxes, relative to the radii of both bodies: 48 roundings along an
/// axis, four of them because a box's axes are perpendicular only up to rounding; along three perpendicular axes the
/// root of three times that. Smaller: a nearer pair may be missed. Larger: more nodes are opened.
inline constexpr double kNodePairSlack = 5e-6;
static_assert(kNodePairSlack > 1.7320509 * gamma_float(48));
/// The same for triangles of two leaves: relative to the radii of both bodies, for rounded corners, and relative to the
/// radii of both leaves, for their projections.
inline constexpr double kCornerSlack = 2e-7, kLeafSlack = 1.1e-6;
static_assert(kCornerSlack > 3 * gamma_float(1) && kLeafSlack > 1.7320509 * gamma_float(10));
/// And relative to the distance that the bound is compared with: 9 roundings along an axis.
inline constexpr double kFarShare = 2e-6;
static_assert(kFarShare > 1.7320509 * gamma_float(9));
/// The error of the gap between two bodies along a direction, in double precision, relative to the extent of the points
/// that are projected.
inline constexpr double kGapRounding = 8 * kRoundoffDouble;

/// Pairs about as near as the best one that are measured before a proof by corners is tried, which visits all corners
/// of both bodies.
inline constexpr std::int64_t kWorthAProof = 4096;
/// Pairs within so many times the difference that a proof allows are counted where a search must know that no proof was
/// tried which could have succeeded: such a proof's pairs are within two, and rounding.
inline constexpr double kTies = 3;

/// A matrix whose rows are orthonormal within this error is used unchanged: kDoublePrecisionSlack covers the error.
/// Others are made orthonormal first.
inline constexpr double kOrthonormal = 4e-15;

/// The error of a point that is placed by the transpose of a pose's matrix in place of its inverse, relative to the
/// body's size: the error of an entry of the matrix times its transpose is kRigidTolerance, of the spectral norm three
/// times that, and a corner of the box is sqrt(3) radii away; the rest covers the rounding of samples to single
/// precision. Smaller: a side may be wrong. Larger: more rays are followed.
inline constexpr double kInverseSlack = 1e-5;
static_assert(kInverseSlack > 3 * 1.8 * kRigidTolerance + 8 * kRoundoffFloat);
/// An upper bound of the factor by which such a matrix may lengthen a vector.
inline constexpr double kRigidRoundUp = 1 + 2e-6;
static_assert(kRigidRoundUp * kRigidRoundUp > 1 + 3 * kRigidTolerance);

/// The automatic tolerance of a sweep, relative to the smaller and to the larger body. Larger: sweeps are faster, but
/// report hits of bodies that pass each other. They are powers of two, so that scaling both bodies by a power of two
/// scales the tolerance exactly.
inline constexpr double kSweepTolerance = 0x1p-15, kLeastSweepTolerance = 0x1p-40;
/// The jump of a body from one time to the next, relative to its coordinates: a pose at some time takes 12 roundings, a
/// corner in it 4 more. Smaller: a sweep misses contacts at a rounded pose.
inline constexpr double kPoseRounding = 16 * kRoundoffDouble;
/// The time that may be lost in an addition of times near 1, which are rounded by 1e-16, times two for safety. Smaller:
/// bodies on motions 1e10 times their size jump past each other.
inline constexpr double kTimeRounding = 4e-16;
/// If points of two triangles are nearer than this share of a sweep's tolerance, the direction between them is
/// rounding.
inline constexpr double kSureDirection = 1e-3;

/// The share of a sweep's tolerance that boxes leave between them. Below 1, so that the first triangles that are looked
/// at where boxes stop are a hit, and all that waits behind it is dropped. Smaller: what passes within the tolerance is
/// a hit less often. At least a half, which the triangles keep.
inline constexpr double kNodeReserve = 0.9375;

/// A time after the end of every motion, which is 1.
inline constexpr double kNever = 2;

// The constants below decide time only. They were measured on the pairs of script/bench pairs.

/// A bounding sphere is advanced while its steps are longer than this share of its radius: shorter steps cost more than
/// advancing its sixteen children.
inline constexpr float kWorthwhileStep = 0.5f;
/// The sphere of a triangle has no children: it stops at this share of the fine field's spacing.
inline constexpr float kWorthwhileTriangleStep = 0.25f;
/// On a GPU a triangle that has stopped is tested against the target's triangles over this many field spacings of its
/// path.
inline constexpr double kLookAhead = 1.0;
/// A probe is small if its radius times this is less than the target's. Measured on flies in labyrinths and on scans:
/// between 4 and 30 it makes no difference.
inline constexpr double kSmallProbe = 8;
/// A pair of nodes is advanced while it moves by more than this share of the larger box in a step: shorter steps cost
/// more than its children's.
inline constexpr double kWorthwhileNodeStep = 0.1;
/// After so many steps for each leaf of both bodies a sweep finds the orbits of all nodes, which takes about half as
/// long as these steps.
inline constexpr std::int64_t kWorthOrbits = 2;
/// The triangles of two leaves are followed for the time in which they move by the larger box's size; for a shorter
/// one, but not for less than this share of it, while more pairs than this may meet.
inline constexpr float kLeastShare = 0.03f;
inline constexpr int kPairsAtOnce = 16;

}  // namespace standoff::collision
