// SPDX-License-Identifier: Apache-2.0
// The kernel that sets up triangles for queries at points, and the error bounds of distances from them.
#pragma once

#include "field/cpu/kernels/triangle_frames.inl"
#include "points/cpu/kernels.h"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// The error of a distance from a frame: a share of the largest coordinate, with a quarter more for the rounding of the
// coordinates themselves; and kLeastSlack, because a side shorter than the root of kLeastLengthSq counts as zero.
constexpr float kSlackOfFrame = 1.25f * kFrameError, kLeastSlack = 2e-6f;
// Covers the rounding of the lines below.
constexpr float kRounding = 0x1p-20f;

// An error s of the distance d as an error of d^2, without a root: (d-s)^2 >= d^2 (1-a) - s^2/a, (d+s)^2 <= d^2 (1+a) +
// s^2 (1+1/a). Any a is safe. It decides how many triangles are compared in double for nothing, and is best at s/d.
struct Slack {
  float share;  // a
  float sq;     // s^2 (1+1/a)
};
// `farthest` bounds the coordinates of the points relative to the frames' center, `extent` those of the corners.
STANDOFF_INLINE Slack slack_of(float farthest, float extent) {
  constexpr float kLeastShare = 0x1p-18f, kMostShare = 0x1p-13f;
  const float slack = (farthest > extent ? farthest : extent) * kSlackOfFrame + kLeastSlack;
  const float distance = farthest - extent;  // a good estimate if the points are far
  float share = kMostShare;
  if (slack < kMostShare * distance) share = slack > kLeastShare * distance ? slack / distance : kLeastShare;
  return {share + kRounding, slack * slack * ((1 + 1 / share) * (1 + kRounding))};
}
STANDOFF_INLINE WideFloat at_least(const WideFloat& sq, const Slack& slack) {
  return fma(sq, WideFloat(1 - slack.share), WideFloat(-slack.sq));
}
STANDOFF_INLINE WideFloat at_most(const WideFloat& sq, const Slack& slack) {
  return fma(sq, WideFloat(1 + slack.share), WideFloat(slack.sq));
}

// The number of triangles of a node of level 0.
STANDOFF_INLINE int size_of_node(const BvhView& tree, std::uint32_t number) {
  const std::uint32_t left = tree.triangles - number * kLanes;
  return left < kLanes ? static_cast<int>(left) : kLanes;
}
STANDOFF_INLINE const double* corner_of(const BvhView& tree, std::uint32_t triangle, int which) {
  return tree.vertices + 3 * std::size_t{tree.corners[3 * std::size_t{triangle} + static_cast<unsigned>(which)]};
}

// Lanes left over repeat the last triangle.
void make_frames(const BvhView& tree, std::uint32_t number, double scale, const double (&center)[3], NodeFrames& to) {
  const int count = size_of_node(tree, number);
  const auto triangle = [&](int lane) __attribute__((always_inline)) {
    return tree.index[number * kLanes + static_cast<unsigned>(lane < count ? lane : count - 1)];
  };
  const double* const amid = corner_of(tree, triangle(count / 2), 0);
  double middle[4] = {};
  for (int axis = 0; axis < 3; ++axis) {
    // The offset is a float, so that adding it to the center loses nothing.
    to.center[axis] = static_cast<double>(static_cast<float>(amid[axis] * scale - center[axis]));
    middle[axis] = center[axis] + to.center[axis];
  }
  alignas(64) CornerRows rows;
  for (int lane = 0; lane < kLanes; ++lane)
    for (int which = 0; which < 3; ++which)
      store_local(rows[which][lane], corner_of(tree, triangle(lane), which), scale, middle);
  const auto corner = [&](int which) __attribute__((always_inline)) {
    return WidePoint{load_column(rows[which], 0), load_column(rows[which], 1), load_column(rows[which], 2)};
  };
  const WidePoint a = corner(0), b = corner(1), c = corner(2);
  store_frames(make_frame(a, b, c, WideFloat(kLeastLengthSq)), to.frame);
  WideFloat farthest(0);
  for (int axis = 0; axis < 3; ++axis)
    farthest = max(farthest, max(abs(component(a, axis)), max(abs(component(b, axis)), abs(component(c, axis)))));
  to.extent = reduce_max(farthest);
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
