// SPDX-License-Identifier: Apache-2.0
// Sixteen boxes side by side, as wide registers load them: the children of one node of a BVH. On the CPU and on GPUs.
#pragma once

#include <cstdint>
#include <limits>

namespace standoff {

/// Lanes without a box hold one that nothing meets: low above high.
struct alignas(64) Boxes16 {
  static constexpr int kLanes = 16;

  float low[3][kLanes];
  float high[3][kLanes];

  void clear(int lane) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis][lane] = std::numeric_limits<float>::infinity();
      high[axis][lane] = -std::numeric_limits<float>::infinity();
    }
  }
};

/// One box.
struct FloatBox {
  float low[3] = {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
                  std::numeric_limits<float>::infinity()};
  float high[3] = {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                   -std::numeric_limits<float>::infinity()};

  void include(const float* p) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = p[axis] < low[axis] ? p[axis] : low[axis];
      high[axis] = p[axis] > high[axis] ? p[axis] : high[axis];
    }
  }
  void include(const FloatBox& box) {
    include(box.low);
    include(box.high);
  }
  void grow(float by) {
    for (int axis = 0; axis < 3; ++axis) low[axis] -= by, high[axis] += by;
  }
};

inline FloatBox lane_of(const Boxes16& boxes, int lane) {
  FloatBox box;
  for (int axis = 0; axis < 3; ++axis) box.low[axis] = boxes.low[axis][lane], box.high[axis] = boxes.high[axis][lane];
  return box;
}

/// Bits of the lanes whose box has a point in common with another one.
inline std::uint32_t overlapping(const Boxes16& boxes, const FloatBox& box) {
  alignas(64) static constexpr std::int32_t kBit[Boxes16::kLanes] = {
      1 << 0, 1 << 1, 1 << 2,  1 << 3,  1 << 4,  1 << 5,  1 << 6,  1 << 7,
      1 << 8, 1 << 9, 1 << 10, 1 << 11, 1 << 12, 1 << 13, 1 << 14, 1 << 15};
  std::int32_t bits = 0;
  for (int n = 0; n < Boxes16::kLanes; ++n) {
    const bool meets = (boxes.low[0][n] <= box.high[0]) & (box.low[0] <= boxes.high[0][n]) &
                       (boxes.low[1][n] <= box.high[1]) & (box.low[1] <= boxes.high[1][n]) &
                       (boxes.low[2][n] <= box.high[2]) & (box.low[2] <= boxes.high[2][n]);
    bits |= -static_cast<std::int32_t>(meets) & kBit[n];
  }
  return static_cast<std::uint32_t>(bits);
}

}  // namespace standoff
