// SPDX-License-Identifier: Apache-2.0
// The terms of the sums that tell whether a mesh is closed and faces outwards (closed.cpp), for host and device.
#pragma once

#include <cstdint>

#include "core/hashes.h"
#include "geometry/triple.h"
#include "standoff/vec.h"

namespace standoff {

/// A random place of a plane for each position. Coordinates are numbers modulo 2^64.
struct Place {
  std::uint64_t x, y;
};
constexpr Place place_of(const Vec3& v) {
  const std::uint64_t x = position_hash(v);
  return {x, splitmix64(x)};
}

/// Twice the signed area of a triangle. These add up to 0 if the edges of a mesh cancel (closed.cpp).
constexpr std::uint64_t twice_area(const Place& a, const Place& b, const Place& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Sums over triangles that share vertices, or the terms of one of them.
struct OutwardTerms {
  /// What sums over a closed mesh may miss by rounding, as a share of the sums of magnitudes.
  static constexpr double kRounding = 1e-12;

  double volume = 0, volume_magnitude = 0;  ///< six times that of the tetrahedra from an origin
  Vec3 normal;                              ///< its length is twice the area
  double normal_magnitude = 0;

  /// The terms of a triangle. `origin`: one vertex of the set, so that a small part far away loses nothing.
  STANDOFF_HD static OutwardTerms of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& origin) {
    const Vec3 normal = cross(b - a, c - a);
    const double volume = dot(a - origin, normal);
    return {volume, abs(volume), normal, largest(normal)};
  }
  STANDOFF_HD void add(const OutwardTerms& other) {
    volume += other.volume;
    volume_magnitude += other.volume_magnitude;
    normal = normal + other.normal;
    normal_magnitude += other.normal_magnitude;
  }
  /// The normals of a closed set add up to 0, and only then its volume does not depend on the origin.
  STANDOFF_HD bool faces_outwards() const {
    return largest(normal) <= kRounding * normal_magnitude && (!has_area() || volume > kRounding * volume_magnitude);
  }
  /// The same, of sums in any order: false also where rounding in another order might change the answer.
  STANDOFF_HD bool surely_faces_outwards() const {
    return largest(normal) <= kRounding / 2 * normal_magnitude &&
           (!has_area() || volume > 2 * kRounding * volume_magnitude);
  }
  STANDOFF_HD bool has_area() const { return normal_magnitude > 0; }

 private:
  STANDOFF_HD static double largest(const Vec3& v) { return max(max(abs(v.x), abs(v.y)), abs(v.z)); }
};

}  // namespace standoff
