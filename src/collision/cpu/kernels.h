// The inner loops of the queries, one set for each instruction set; the answers do not depend on it.
#pragma once

#include <cstdint>
#include <span>

#include "collision/body/simd_blocks.h"

namespace standoff::collision {

struct Kernels {
  const char* name;
  /// Lower bounds of the distance between 16 balls, placed in the field's frame, and the surface: negative where a
  /// ball may touch. Where a bound from the coarse field exceeds `enough`, the fine field is not asked.
  void (*gaps)(const FieldView&, const FloatPlace&, const Balls&, float enough, float* gap);
  /// The same for balls each at its own place already: centres in the field's frame.
  void (*gaps_at)(const FieldView&, const float (*center)[kLanes], const float* radius, float enough, float* gap);
  /// Bit n: box n and `box` share a point.
  std::uint32_t (*overlaps)(const Boxes&, const FloatBox& box);
  /// Squared distances between the boxes and `box`.
  void (*distances_sq)(const Boxes&, const FloatBox& box, float* distance_sq);
  /// Places 16 triangles in another frame, and their boxes grown by `by`; `all` becomes the box around those.
  void (*place_faces)(const FloatPlace&, const Faces&, float by, Faces& placed, Boxes& boxes, FloatBox& all);
  /// The pairs of triangles, one of each packet, whose boxes share a point and which neither triangle's plane keeps
  /// more than `apart` from each other. Fastest where b is the one with fewer lanes. Returns how many.
  int (*close_lanes)(const Packet& a, const Packet& b, float apart, LanePair* pairs);
  /// Decides eight pairs in the world; where `place_p` or `place_q` is given, their corners are still to be taken
  /// there.
  void (*meet)(const TrianglePairs&, const DoublePlace* place_p, const DoublePlace* place_q, Meetings&);
  /// The closest points of eight pairs that do not cross, placed as for `meet`.
  void (*closest)(const TrianglePairs&, const DoublePlace* place_p, const DoublePlace* place_q, ClosestOfPairs&);
};

/// The kernels for this processor.
const Kernels& kernels();
/// All that this processor can run, best first, for tests.
std::span<const Kernels* const> all_kernels();

}  // namespace standoff::collision
