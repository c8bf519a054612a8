// SPDX-License-Identifier: Apache-2.0
// What a rim adds to the winding number: the solid angle of its cap, over 4 pi.
#pragma once

#include "sign/open_winding/linear_field.h"
#include "sign/open_winding/rims.h"

namespace standoff {

/// The side of the plane of a, b and c that p + (e^3, e, e^2) is on, e infinitely small: that of ray_crossing.h. 0 only
/// for triangles without area.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

/// The solid angle that the triangles (apex, corner, next corner) fill seen from p, over 4 pi, times the weight: the
/// generalised winding number of a mesh is the winding number of the mesh with all caps, plus these of all rims.
struct CapAngle {
  double value;
  double error;  ///< a bound of its rounding
};

/// It jumps at the cap by the rim's weight, at the same points, bit by bit, where RayTriangle of the cap's triangles
/// takes a sample to be past them: exactly, with the same symbolic perturbation.
CapAngle cap_angle(const Rim& rim, const Vec3& p);

/// The part of one triangle of the cap, that of the edge from corner `edge` to the next one.
CapAngle edge_angle(const Rim& rim, std::size_t edge, const Vec3& p);

/// The same as a linear function in the cell, continued across the cap if that is in the cell: the angle at the
/// center, and the gradient, which depends on the rim alone. The error is infinite if an edge of the rim may be within
/// the cell's radius.
LinearField cap_field(const Rim& rim, const Cell& cell);

}  // namespace standoff
