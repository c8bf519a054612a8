// How far an answer may be off, in one place. Units of rounding: one is the epsilon of double times a length, that of
// the longest side of the box around both bodies in the world, and where a result is a place in the world also their
// farthest coordinate, for no double is nearer to it.
#pragma once

namespace difi::testing {

// Distances, and so what a margin decides.
inline constexpr double kDistanceUnits = 16;
// Nearest points, from the triangles they are said to lie on.
inline constexpr double kPointUnits = 32;
// A contact's point from both of its triangles, and how far beyond its depth b moves along its normal until they are
// apart: 1e-9 of the size, where edges graze the other's plane.
inline constexpr double kContactUnits = 4.5e6;
// The place of a body on its way, at a time that is a double.
inline constexpr double kWayUnits = 64;
// Lengths of unit vectors, in epsilons.
inline constexpr double kUnitLengthUnits = 16;

}  // namespace difi::testing
