// SPDX-License-Identifier: Apache-2.0
// The kernel that looks at the boxes of a pack along a row.
#pragma once

#include "field/cpu/kernels/target.inl"
#include "points/cpu/kernels.h"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

std::uint32_t boxes_before(const PackContents& pack, const float (&point)[3], float from) {
  Mask meets = mask_from_bits((1u << pack.count) - 1) &
               less_equal(WideFloat::load(pack.boxes->low[0]), WideFloat(point[0])) &
               less_equal(WideFloat(from), WideFloat::load(pack.boxes->high[0]));
  for (int axis = 1; axis < 3; ++axis)
    meets = meets & less_equal(WideFloat::load(pack.boxes->low[axis]), WideFloat(point[axis])) &
            less_equal(WideFloat(point[axis]), WideFloat::load(pack.boxes->high[axis]));
  return meets.to_bits();
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
