// SPDX-License-Identifier: Apache-2.0
// Sixteen spheres or boxes at a time: what the kernels work on. Lanes without content hold an empty sphere or box.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "geometry/triple.h"

namespace standoff::collision {

inline constexpr int kLanes = 16;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct alignas(64) Sphere16 {
  float center[3][kLanes];
  float radius[kLanes];  ///< minus infinity: no sphere
};

struct alignas(64) Aabb16 {
  float min[3][kLanes];
  float max[3][kLanes];
};

/// Triangles: corner, axis, lane.
struct alignas(64) Triangle16 {
  float corner[3][3][kLanes];
};

/// Pairs of triangles at a time: as many doubles as a 512-bit register holds.
inline constexpr int kPairs = 8;

/// Corner, axis, lane.
struct alignas(64) TrianglePairs {
  double p[3][3][kPairs], q[3][3][kPairs];
};

/// Which of eight pairs intersect, and their point, normal and depth as in Penetration.
struct alignas(64) PairOverlaps {
  double point[3][kPairs];
  double normal[3][kPairs];
  double depth[kPairs];
  std::uint32_t intersecting;  ///< bit n: pair n intersects, for certain; only then its numbers mean something
  std::uint32_t
      inaccurate;  ///< bit n: it intersects, but point, normal and depth may err by more than penetration() promises
  std::uint32_t unsure;  ///< bit n: rounding may hide the answer
};

/// The closest points of eight pairs that do not cross.
struct alignas(64) ClosestOfPairs {
  double distance_sq[kPairs];
  double on_p[3][kPairs], on_q[3][kPairs];
};

/// Asks the memory for all lines of something before the first is needed.
template <class T>
inline void fetch(const T& what) {
  for (std::size_t line = 0; line < sizeof(T); line += 64)
    __builtin_prefetch(reinterpret_cast<const char*>(&what) + line);
}

/// One box.
struct FloatBox {
  float min[3] = {kInfinity, kInfinity, kInfinity};
  float max[3] = {-kInfinity, -kInfinity, -kInfinity};

  void include(const float* p) {
    for (int axis = 0; axis < 3; ++axis) {
      min[axis] = p[axis] < min[axis] ? p[axis] : min[axis];
      max[axis] = p[axis] > max[axis] ? p[axis] : max[axis];
    }
  }
  void include(const FloatBox& box) {
    include(box.min);
    include(box.max);
  }
  void grow(float by) {
    for (int axis = 0; axis < 3; ++axis) min[axis] -= by, max[axis] += by;
  }
};

inline FloatBox lane_of(const Aabb16& boxes, int lane) {
  FloatBox box;
  for (int axis = 0; axis < 3; ++axis) box.min[axis] = boxes.min[axis][lane], box.max[axis] = boxes.max[axis][lane];
  return box;
}

/// Some of sixteen triangles, and their boxes.
struct TriangleSubset {
  const Triangle16* triangles;
  const Aabb16* boxes;
  std::uint32_t lanes;  ///< bits
};

/// A lane of one packet and one of another.
struct LanePair {
  std::uint8_t a, b;
};

}  // namespace standoff::collision
