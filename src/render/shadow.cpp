// SPDX-License-Identifier: Apache-2.0
#include "render/shadow.h"

#include <atomic>

namespace standoff {

Shadow::Shadow(const Occlusion& occlusion, Float3 to_lamp)
    : occlusion_(occlusion), to_lamp_(to_lamp), known_(occlusion.lattice().samples(), -1.0F) {}

float Shadow::at_sample(std::size_t sample) const {
  const std::atomic_ref known(known_[sample]);
  float passes = known.load(std::memory_order_relaxed);
  if (passes < 0) {
    passes = occlusion_.lamp(occlusion_.lattice().place(sample), to_lamp_);
    known.store(passes, std::memory_order_relaxed);
  }
  return passes;
}

float Shadow::passing(Float3 point, Float3 normal) const {
  const UnitLattice& lattice = occlusion_.lattice();
  const auto cell = lattice.cell(occlusion_.above(point, normal));
  if (!cell) return 1;
  return lattice.interpolate(*cell, [&](std::size_t sample) { return at_sample(sample); });
}

}  // namespace standoff
