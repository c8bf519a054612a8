// SPDX-License-Identifier: Apache-2.0
// overlapping() of boxes16.h for the instruction set of the kernels that include this.
#pragma once

#include "bvh/boxes16.h"
#include "simd/points.inl"

namespace standoff::STANDOFF_TARGET {
namespace {

std::uint32_t overlapping_lanes(const Boxes16& boxes, const FloatBox& box) {
  const WidePoint low = load_points(boxes.low), high = load_points(boxes.high);
  const auto meet = [&](const WideFloat& l, const WideFloat& h, int axis) __attribute__((always_inline)) {
    return less_equal(l, WideFloat(box.high[axis])) & less_equal(WideFloat(box.low[axis]), h);
  };
  return (meet(low.x, high.x, 0) & meet(low.y, high.y, 1) & meet(low.z, high.z, 2)).to_bits();
}

}  // namespace
}  // namespace standoff::STANDOFF_TARGET
