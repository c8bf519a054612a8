// The inner loops of the queries, one set for each instruction set; the answers do not depend on it.
#pragma once

#include <cstdint>

#include "collision/packets.h"

namespace difi::collision {

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
  /// Places 16 triangles in another frame, and their boxes grown by `by`.
  void (*place_faces)(const FloatPlace&, const Faces&, float by, Faces& placed, Boxes& boxes);
  /// Bit n: neither the plane of face n nor that of lane `lane` of `others` keeps the two triangles more than `apart`
  /// from each other.
  std::uint32_t (*not_parted)(const Faces&, const Faces& others, int lane, float apart);
};

/// The kernels for this processor.
const Kernels& kernels();
/// The others, for tests: those that this processor can run.
const Kernels* const* all_kernels();

}  // namespace difi::collision
