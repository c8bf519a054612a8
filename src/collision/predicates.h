// Signs of determinants, exact: a double computation with an error bound decides nearly always, expansions the rest.
#pragma once

#include "difi/vec.h"

namespace difi {

/// The sign of det(b - a, c - a, d - a): 1 where d lies on the side of abc that (b - a) x (c - a) points to, 0 exactly
/// where the four lie in a plane. Exact for coordinates that are zero or of magnitude 1e-90 to 1e100.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// A point in the plane.
struct Flat {
  double x, y;
};

/// The sign of det(b - a, c - a): 1 where a, b, c turn left; 0 exactly where they lie on a line.
int orient2d(const Flat& a, const Flat& b, const Flat& c);

}  // namespace difi
