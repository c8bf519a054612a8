// SPDX-License-Identifier: Apache-2.0
// A plane of a field between its samples: the value there, and where the band ends.
#pragma once

#include "render/plane.h"

namespace standoff {

class SliceTexture {
 public:
  SliceTexture(const DistanceField& field, const SliceOptions& where);

  const Plane& plane() const { return plane_; }
  float thickness() const { return thickness_; }

  struct Values {
    float value;  ///< linear between samples; not finite beside those that are not
    float edge;   ///< as beyond_band(): the band ends where its magnitude is the thickness
  };
  /// At a place counted in samples from the lower left one; the nearest one of the plane for places outside.
  Values at(float right, float up) const;

 private:
  Plane plane_, extended_;
  float thickness_;
};

}  // namespace standoff
