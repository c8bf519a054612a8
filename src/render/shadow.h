// SPDX-License-Identifier: Apache-2.0
// The shadow of a lamp: how much of its light passes, found once for each sample of the occluders' lattice that a
// picture asks for.
#pragma once

#include <vector>

#include "render/occlusion.h"

namespace standoff {

class Shadow {
 public:
  /// Of a distant lamp. `occlusion` must outlive it.
  Shadow(const Occlusion& occlusion, Float3 to_lamp);

  /// The share of the light that reaches a point of a surface with a unit normal, 0 to 1. For any number of threads.
  float passing(Float3 point, Float3 normal) const;

 private:
  float at_sample(std::size_t sample) const;

  const Occlusion& occlusion_;
  Float3 to_lamp_;
  // Negative: not known yet. Threads that find the same sample's find the same number.
  mutable std::vector<float> known_;
};

}  // namespace standoff
