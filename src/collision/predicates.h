// Signs of determinants, exact: a double computation with an error bound decides nearly always, expansions the rest.
#pragma once

#include <cmath>

#include "difi/vec.h"

namespace difi {

/// The sign of det(b - a, c - a, d - a): 1 where d lies on the side of abc that (b - a) x (c - a) points to, 0 exactly
/// where the four lie in a plane. Exact for coordinates that are zero or of magnitude 1e-90 to 1e100.
inline int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// The same by expansions alone.
int orient3d_exactly(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// A point in the plane.
struct Flat {
  double x, y;
};

/// The sign of det(b - a, c - a): 1 where a, b, c turn left; 0 exactly where they lie on a line.
int orient2d(const Flat& a, const Flat& b, const Flat& c);

inline int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double vxwy = v.x * w.y, vywx = v.y * w.x, uxwy = u.x * w.y, uywx = u.y * w.x, uxvy = u.x * v.y,
               uyvx = u.y * v.x;
  const double det = u.z * (vxwy - vywx) - v.z * (uxwy - uywx) + w.z * (uxvy - uyvx);
  const double size = (std::abs(vxwy) + std::abs(vywx)) * std::abs(u.z) +
                      (std::abs(uxwy) + std::abs(uywx)) * std::abs(v.z) +
                      (std::abs(uxvy) + std::abs(uyvx)) * std::abs(w.z);
  // The bound holds where nothing underflows; products below 1e-290 go the exact way, which loses nothing above 1e-90.
  constexpr double kEps = 0x1p-53, kBound3d = (7 + 56 * kEps) * kEps;  // Shewchuk's first stage
  const double bound = kBound3d * size + 1e-290;
  if (det > bound) return 1;
  if (-det > bound) return -1;
  return orient3d_exactly(a, b, c, d);
}

}  // namespace difi
