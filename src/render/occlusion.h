// SPDX-License-Identifier: Apache-2.0
// How much of the sky and of the lamp a point of a surface sees, from a coarse distance field of everything opaque.
#pragma once

#include <span>
#include <vector>

#include "render/part.h"
#include "standoff/grid.h"

namespace standoff {

class Occlusion {
 public:
  /// Of the opaque parts that cast shadows; everything is bright if there are none.
  explicit Occlusion(std::span<const DrawnPart> parts);

  /// The share of the light from all sides that reaches a point of a surface with a unit normal, 0 to 1.
  float ambient(Float3 point, Float3 normal) const;
  /// The share of a distant lamp's light that passes, 0 to 1; softly, as if the lamp were large.
  float lamp(Float3 point, Float3 normal, Float3 to_lamp) const;

  /// Bytes of the field and of what computing it takes, for so many triangles and vertices.
  static std::int64_t bytes(std::int64_t triangles, std::int64_t vertices);

 private:
  float distance(Float3 point) const;

  std::vector<float> distances_;  // x fastest; empty: nothing casts shadows
  Float3 origin_;
  float spacing_ = 1, thickness_ = 0;
  int size_[3] = {0, 0, 0};
};

}  // namespace standoff
