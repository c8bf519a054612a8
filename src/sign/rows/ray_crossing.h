// SPDX-License-Identifier: Apache-2.0
// Where a row of samples, a ray along +x, crosses a triangle. All decisions are exact signs of determinants: rounded
// determinants decide where their error bound lets them, else geometry/predicates.h. So neighbouring triangles agree on
// the edge between them.
//
// Rays through an edge, a corner, or along a triangle are no special cases: every sample (x, y, z) stands for the point
// (x + e^3, y + e, z + e^2), where e is positive and smaller than any number ("simulation of simplicity", Edelsbrunner
// and Muecke 1990). That point is on no triangle with an area.
//
// The functions run on host and device. What decides signs beyond rounding is a parameter, as a GPU has little memory
// for it (cuda/row_steps.cuh).
//
// A ray along y or z is a ray along x in rotated coordinates: (y, z, x) or (z, x, y). Samples must stand for the same
// points then, so that crossings along the three axes agree. They are displaced most along y, then along z, then along
// x: the same cycle, begun at another of the rotated axes.
#pragma once

#include <array>
#include <cstdint>

#include "geometry/host_device.h"
#include "geometry/predicates.h"
#include "sign/rows/sample_axis.h"
#include "standoff/vec.h"

namespace standoff {

/// The signs of determinants, on the host.
struct ExactSigns {
  static int orient2d(const Flat& a, const Flat& b, const Flat& c) { return standoff::orient2d(a, b, c); }
  static int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return standoff::orient3d(a, b, c, d);
  }
};

/// A triangle that many rows are tested against.
class RayTriangle {
 public:
  /// `most`: the axis, 0 to 2 for x to z, along which samples are displaced most. The two axes after it in the cycle
  /// follow.
  STANDOFF_HD explicit RayTriangle(const std::array<Vec3, 3>& corners, int most = 1) : t_(corners), most_(most) {
    const Vec3 u = t_[1] - t_[0], v = t_[2] - t_[0];
    const auto minor = [](double a, double b, double c, double d) {
      return RoundedDeterminant{a * b - c * d, abs(a * b) + abs(c * d)};
    };
    normal_ = {minor(u.y, v.z, u.z, v.y), minor(u.z, v.x, u.x, v.z), minor(u.x, v.y, u.y, v.x)};
  }

  const std::array<Vec3, 3>& corners() const { return t_; }

  /// 1 where the row through (y, z) leaves the solid at this triangle, which is where the normal has a positive x; -1
  /// where it enters it; 0 where it misses the triangle.
  template <class Signs>
  STANDOFF_HD int crossing(double y, double z, Signs& signs) const {
    bool left = true, right = true;
    for (int n = 0; n < 3; ++n) {
      const RoundedDeterminant det = rounded_determinant2d(flat(n), flat((n + 1) % 3), {y, z});
      const double bound = kRounded2d * det.magnitude + kUnderflowOf2d;
      left &= det.value > bound;
      right &= -det.value > bound;
      if (!(abs(det.value) > bound)) return crossing_near_edge(y, z, signs);
    }
    return int{left} - int{right};
  }
  int crossing(double y, double z) const {
    ExactSigns signs;
    return crossing(y, z, signs);
  }

  /// About where the row through (y, z) crosses the triangle; any number where rounding hides it.
  STANDOFF_HD double crossing_x(double y, double z) const {
    return t_[0].x - (normal_[1].value * (y - t_[0].y) + normal_[2].value * (z - t_[0].z)) / normal_[0].value;
  }

  /// Whether a sample of a row is past the triangle. `crossing` is the crossing of the row, and not 0.
  template <class Signs>
  STANDOFF_HD bool is_past(const Vec3& sample, int crossing, Signs& signs) const {
    const Vec3 w = sample - t_[0];
    const double det = w.x * normal_[0].value + w.y * normal_[1].value + w.z * normal_[2].value;
    const double magnitude =
        abs(w.x) * normal_[0].magnitude + abs(w.y) * normal_[1].magnitude + abs(w.z) * normal_[2].magnitude;
    // This is the form of Shewchuk's first stage, with the same bound.
    if (abs(det) > kRounded3d * magnitude + kUnderflowOf3d) return (det > 0) == (crossing > 0);
    return is_past_near_plane(sample, crossing, signs);
  }
  bool is_past(const Vec3& sample, int crossing) const {
    ExactSigns signs;
    return is_past(sample, crossing, signs);
  }

 private:
  STANDOFF_HD Flat flat(int n) const { return {t_[static_cast<std::size_t>(n)].y, t_[static_cast<std::size_t>(n)].z}; }

  // On which side of the line from corner n to the next one the point (y, z) is: 1 left, -1 right. 0 only if both have
  // the same y and z.
  template <class Signs>
  STANDOFF_HD int side_of_edge(int n, double y, double z, Signs& signs) const {
    const Flat a = flat(n), b = flat((n + 1) % 3);
    if (const int side = signs.orient2d(a, b, {y, z})) return side;
    // Take the derivatives of the determinant along y and z.
    const int along_y = sign_of(a.y - b.y), along_z = sign_of(b.x - a.x);
    const bool z_before_y = most_ == 2;
    const int first = z_before_y ? along_z : along_y, second = z_before_y ? along_y : along_z;
    return first != 0 ? first : second;
  }

  template <class Signs>
  STANDOFF_HD int crossing_near_edge(double y, double z, Signs& signs) const {
    const int side = side_of_edge(0, y, z, signs);
    if (side == 0 || side_of_edge(1, y, z, signs) != side || side_of_edge(2, y, z, signs) != side) return 0;
    return side;
  }

  template <class Signs>
  STANDOFF_HD bool is_past_near_plane(const Vec3& sample, int crossing, Signs& signs) const {
    int side = signs.orient3d(t_[0], t_[1], t_[2], sample);
    // Take its derivatives, which are the parts of the normal.
    for (int n = 0; side == 0; ++n) {
      const int axis = (most_ + n) % 3;
      if (axis == 0) side = crossing;
      if (axis == 1) side = signs.orient2d({t_[0].z, t_[0].x}, {t_[1].z, t_[1].x}, {t_[2].z, t_[2].x});
      if (axis == 2) side = signs.orient2d({t_[0].x, t_[0].y}, {t_[1].x, t_[1].y}, {t_[2].x, t_[2].y});
    }
    return side * crossing > 0;
  }

  std::array<Vec3, 3> t_;
  int most_;
  std::array<RoundedDeterminant, 3> normal_;  // its parts, and the magnitudes of their terms
};

/// The first sample of a row, along x through (y, z), that is past the triangle; or the number of samples. `crossing`
/// is the crossing of the row, and not 0.
template <class Signs>
STANDOFF_HD inline std::int64_t first_past(const RayTriangle& triangle, const SampleAxis& x, double y, double z,
                                           int crossing, Signs& signs) {
  return x.first(triangle.crossing_x(y, z), [&](std::int64_t n) {
    return triangle.is_past({x.at(n), y, z}, crossing, signs);
  });
}

}  // namespace standoff
