// SPDX-License-Identifier: Apache-2.0
// What darkens surfaces: a coarse distance field of everything opaque.
#pragma once

#include <span>
#include <vector>

#include "render/part.h"
#include "render/unit_lattice.h"
#include "standoff/grid.h"

namespace standoff {

class Occlusion {
 public:
  /// Of the opaque parts that cast shadows; everything is bright if there are none.
  explicit Occlusion(std::span<const DrawnPart> parts);

  /// The share of the light from all sides that reaches a point of a surface with a unit normal, 0 to 1.
  float ambient(Float3 point, Float3 normal) const;
  /// The share of a distant lamp's light that reaches a place, 0 to 1; softly, as if the lamp were large.
  float lamp(Float3 place, Float3 to_lamp) const;
  /// The place above a point of a surface from where the field tells how far away everything else is.
  Float3 above(Float3 point, Float3 normal) const;
  /// Of the field; empty if nothing casts shadows.
  const UnitLattice& lattice() const { return lattice_; }

  /// Bytes of the field and of what computing it takes, for so many triangles and vertices.
  static std::int64_t bytes(std::int64_t triangles, std::int64_t vertices);

 private:
  float distance(Float3 place) const;

  UnitLattice lattice_;
  float thickness_ = 0;
  std::vector<float> distances_;
};

}  // namespace standoff
