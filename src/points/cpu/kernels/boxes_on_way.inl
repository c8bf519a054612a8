// SPDX-License-Identifier: Apache-2.0
// The kernel that looks at the boxes of a pack along a row.
#pragma once

#include "field/cpu/kernels/triangle_frames.inl"
#include "points/cpu/kernels.h"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

std::uint32_t boxes_on_way(const PackContents& pack, const float (&low)[3], const float (&high)[3]) {
  Mask meets = mask_from_bits((1u << pack.count) - 1);
  for (int axis = 0; axis < 3; ++axis)
    meets = meets & less_equal(WideFloat::load(pack.boxes->low[axis]), WideFloat(high[axis])) &
            less_equal(WideFloat(low[axis]), WideFloat::load(pack.boxes->high[axis]));
  return meets.to_bits();
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
