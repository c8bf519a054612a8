// How far an answer may be off, in one place. Units of rounding: one is the epsilon of double times a length, that of
// the longest side of the box around both bodies in the world, and where a result is a place in the world also their
// farthest coordinate, for no double is nearer to it.
#pragma once

namespace difi::testing {

// Distances, and so what a margin decides.
inline constexpr double kDistanceUnits = 16;
// Points that are said to lie on a triangle, from the triangle.
inline constexpr double kPointUnits = 16;
// What a pair of triangles is moved along a contact's normal beyond its depth until it is apart.
inline constexpr double kPartingUnits = 16;
// The place of a body on its way, at a time that is a double.
inline constexpr double kWayUnits = 64;
// Lengths of unit vectors, in epsilons.
inline constexpr double kUnitLengthUnits = 16;

}  // namespace difi::testing
