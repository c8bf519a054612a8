// SPDX-License-Identifier: Apache-2.0
// Triangles in shared memory, set up for the samples of one tile.
#pragma once

#include "field/cuda/corners.cuh"
#include "field/set_up.h"

namespace standoff::STANDOFF_PLATFORM {

/// One triangle ready to be measured to: a frame, or where it is long the lines of one. Eleven loads of 16 bytes, and
/// 44 words apart: loads by neighbouring threads of neighbouring triangles then never conflict in a bank of shared
/// memory.
struct alignas(16) Staged {
  float number[44];
};

template <class Setup, class Words>
STANDOFF_DEVICE void store(const Setup& setup, Words& to) {
  static_assert(sizeof setup <= sizeof to);
  __builtin_memcpy(&to, &setup, sizeof setup);
}
template <class Setup, class Words>
STANDOFF_DEVICE Setup load(const Words& from) {
  Setup setup;
  __builtin_memcpy(&setup, &from, sizeof setup);
  return setup;
}

struct Stage {
  static constexpr int kTriangles = 128;
  Staged setup[kTriangles];
  float slack[kTriangles];  // what a distance may be off by when tiles and blocks are culled
  std::uint32_t index[kTriangles];
  unsigned char is_long[kTriangles];
  float low[3][kTriangles], high[3][kTriangles];  // its box, relative to the brick's centre
};

/// The squared distance from p to staged triangle n.
STANDOFF_DEVICE float staged_distance_sq(const Stage& stage, int n, const Triple<float>& p) {
  if (stage.is_long[n]) return distance_sq(load<TriangleLines<float>>(stage.setup[n]), p);
  return distance_sq(load<TriangleFrame<float>>(stage.setup[n]), p);
}

/// Sets up a triangle relative to a brick's centre, exactly as the CPU does.
STANDOFF_DEVICE void set_up(const Lattice& l, const DeviceMesh& mesh, std::uint32_t triangle,
                            const Triple<double>& center, Stage& stage, int n) {
  const Corners c = corners_of(mesh, triangle);
  const Triple<double> a = local(l, c.at[0], center), b = local(l, c.at[1], center), d = local(l, c.at[2], center);
  const Triple<float> fa = narrowed(a), fb = narrowed(b), fd = narrowed(d);
  const BoxOf<float> box = box_of(fa, fb, fd);
  stage.index[n] = triangle;
  stage.slack[n] = fma(farthest_coordinate(box), kSlackOfCoordinate, kSlack);
  stage.is_long[n] = is_long(box);
  stage.low[0][n] = box.low.x, stage.low[1][n] = box.low.y, stage.low[2][n] = box.low.z;
  stage.high[0][n] = box.high.x, stage.high[1][n] = box.high.y, stage.high[2][n] = box.high.z;
  if (stage.is_long[n])
    store(make_lines<float>(make_frame(a, b, d, double{kLeastLengthSq})), stage.setup[n]);
  else
    store(make_frame(fa, fb, fd, float{kLeastLengthSq}), stage.setup[n]);
}

}  // namespace standoff::STANDOFF_PLATFORM
