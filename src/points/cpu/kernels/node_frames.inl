// SPDX-License-Identifier: Apache-2.0
// The kernel that sets up triangles for queries at points, and how far off what is measured with them may be.
#pragma once

#include "field/cpu/kernels/triangle_frames.inl"
#include "points/cpu/kernels.h"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// What a distance from a frame may be off by: a share of the largest coordinate, with a quarter more for the rounding
// of the coordinates themselves, and what is lost where a side shorter than the root of kLeastLengthSq counts as zero.
constexpr float kSlackOfFrame = 1.25f * kFrameError, kLeastSlack = 2e-6f;
// What covers the rounding of the lines below.
constexpr float kRounding = 0x1p-20f;

// A slack s in the distance d, allowed for without a root: (d-s)^2 >= d^2 (1-a) - s^2/a, (d+s)^2 <= d^2 (1+a) +
// s^2 (1+1/a). Any a is safe; it decides how many triangles are compared in double for nothing, and is best at s/d.
struct Slack {
  float share;  // a
  float sq;     // s^2 (1+1/a)
};
// `farthest`: no coordinate of the points relative to the frames' center is larger; `extent`: nor one of the corners.
STANDOFF_INLINE Slack slack_of(float farthest, float extent) {
  constexpr float kLeastShare = 0x1p-18f, kMostShare = 0x1p-13f;
  const float slack = (farthest > extent ? farthest : extent) * kSlackOfFrame + kLeastSlack;
  const float distance = farthest - extent;  // about that, where the points are far
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

// How many triangles a node of level 0 has.
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
    // A float, so that it is the same relative to the center and added to it.
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
