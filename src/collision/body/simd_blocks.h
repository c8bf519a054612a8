// Sixteen balls or boxes at a time: what the kernels work on. Lanes without content hold an empty ball or box.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "geometry/transform.h"

namespace standoff::collision {

inline constexpr int kLanes = 16;
inline constexpr float kNothing = std::numeric_limits<float>::infinity();

struct alignas(64) Balls {
  float center[3][kLanes];
  float radius[kLanes];  ///< minus infinity: no ball
};

struct alignas(64) Boxes {
  float min[3][kLanes];
  float max[3][kLanes];
};

/// Triangles: corner, axis, lane.
struct alignas(64) Faces {
  float corner[3][3][kLanes];
};

/// Pairs of triangles at a time: as many doubles as a 512-bit register holds.
inline constexpr int kPairs = 8;

/// Corner, axis, lane.
struct alignas(64) TrianglePairs {
  double p[3][3][kPairs], q[3][3][kPairs];
};

/// Which of eight pairs touch, and where and how deep they are in each other: as overlap() tells it.
struct alignas(64) Meetings {
  double point[3][kPairs];
  double normal[3][kPairs];
  double depth[kPairs];
  std::uint32_t touching;    ///< bit n: pair n touches, for certain; only then its numbers mean something
  std::uint32_t inaccurate;  ///< bit n: it touches, but point, normal and depth may err by more than overlap() promises
  std::uint32_t unsure;      ///< bit n: rounding may hide the answer
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
  float min[3] = {kNothing, kNothing, kNothing};
  float max[3] = {-kNothing, -kNothing, -kNothing};

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

inline FloatBox lane_of(const Boxes& boxes, int lane) {
  FloatBox box;
  for (int axis = 0; axis < 3; ++axis) box.min[axis] = boxes.min[axis][lane], box.max[axis] = boxes.max[axis][lane];
  return box;
}

/// Some of sixteen triangles, and their boxes.
struct Packet {
  const Faces* faces;
  const Boxes* boxes;
  std::uint32_t lanes;  ///< bits
};

/// A lane of one packet and one of another.
struct LanePair {
  std::uint8_t a, b;
};

/// The fields of a body, as the kernels read them (field_bounds.h). Positions are relative to the body's middle.
struct FieldView {
  float origin[3];                        ///< of sample (0,0,0) of both grids
  float spacing, coarse_spacing;          ///< of the fine and the coarse grid
  float per_spacing, per_coarse_spacing;  ///< their reciprocals
  float last[3], coarse_last[3];          ///< the largest index per axis
  std::int32_t tiles[2];                  ///< of the fine grid along x and y
  std::int32_t coarse_size[2];            ///< of the coarse grid along x and y
  float step;                             ///< what one unit of a fine sample stands for
  float min[3], max[3];                   ///< the box of the surface
  const std::int32_t* slots;              ///< per tile: where its 512 samples start, in tiles
  const std::uint8_t* samples;
  const float* coarse;
};

}  // namespace standoff::collision
