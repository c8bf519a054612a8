// SPDX-License-Identifier: Apache-2.0
// The kernels that compare sixteen boxes with one.
#pragma once

#include "collision/cpu/kernels/target.inl"

namespace standoff::collision::STANDOFF_TARGET {
namespace {

std::uint32_t overlaps(const Aabb16& boxes, const FloatBox& box) {
  const WidePoint low = load_points(boxes.min), high = load_points(boxes.max);
  const WidePoint box_low = same_points(box.min), box_high = same_points(box.max);
  const Mask share_x = less_equal(low.x, box_high.x) & less_equal(box_low.x, high.x),
             share_y = less_equal(low.y, box_high.y) & less_equal(box_low.y, high.y),
             share_z = less_equal(low.z, box_high.z) & less_equal(box_low.z, high.z);
  return (share_x & share_y & share_z).to_bits();
}

void distances_sq(const Aabb16& boxes, const FloatBox& box, float* distance_sq) {
  const WidePoint low = load_points(boxes.min), high = load_points(boxes.max);
  const WidePoint zero{WideFloat(0), WideFloat(0), WideFloat(0)};
  const WidePoint gap = max(max(low - same_points(box.max), same_points(box.min) - high), zero);
  (gap.x * gap.x + gap.y * gap.y + gap.z * gap.z).store(distance_sq);
}

}  // namespace
}  // namespace standoff::collision::STANDOFF_TARGET
