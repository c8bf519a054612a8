// SPDX-License-Identifier: Apache-2.0
// The data of kernels on the CPU and on GPUs: a body's two distance fields, the gap of a bounding sphere in them, and
// blocks of sixteen spheres, boxes or triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "bvh/boxes16.h"
#include "geometry/host_device.h"
#include "geometry/triple.h"

namespace standoff::collision {

/// The value of a clamped fine sample: the surface is at least the band's half-width away.
inline constexpr int kClampedSample = 255;

/// A view of FieldBounds (body.h). Positions are relative to the body's middle.
struct FieldView {
  float origin[3];                        ///< of sample (0,0,0) of both grids
  float spacing, coarse_spacing;          ///< of the fine and the coarse grid
  float per_spacing, per_coarse_spacing;  ///< their reciprocals
  float last[3], coarse_last[3];          ///< the last index per axis
  std::int32_t tiles[2];                  ///< of the fine grid along x and y
  std::int32_t coarse_size[2];            ///< of the coarse grid along x and y
  float step;                             ///< the distance of one unit of a fine sample
  float min[3], max[3];                   ///< the box of the surface
  const std::int32_t* slots;              ///< per tile: the start of its 512 samples, in tiles
  const std::uint8_t* samples;
  const float* coarse;
};

/// The tile of the fine sample (i, j, k), and the sample's index in it: tiles of 8x8x8, x fastest in both.
STANDOFF_INLINE std::int32_t tile_of(const FieldView& f, std::int32_t i, std::int32_t j, std::int32_t k) {
  return ((k >> 3) * f.tiles[1] + (j >> 3)) * f.tiles[0] + (i >> 3);
}
STANDOFF_INLINE std::int32_t index_in_tile(std::int32_t i, std::int32_t j, std::int32_t k) {
  return (k & 7) << 6 | (j & 7) << 3 | (i & 7);
}
STANDOFF_INLINE std::uint8_t fine_sample(const FieldView& f, std::int32_t tile, std::int32_t index) {
  return f.samples[(static_cast<std::int64_t>(f.slots[tile]) << 9) + index];
}

STANDOFF_INLINE std::int32_t coarse_index(const FieldView& f, std::int32_t i, std::int32_t j, std::int32_t k) {
  return (k * f.coarse_size[1] + j) * f.coarse_size[0] + i;
}

// The gap of a bounding sphere is a lower bound of its distance from the surface, in single precision. The CPU's loops
// over sixteen spheres and the GPU's thread per sphere share it.
//
// Distance is 1-Lipschitz, so a sample s at x_i gives d(x) >= s - |x - x_i| for every x, and a sphere (x, r) is at
// least d(x) - r away (docs/collision.md). The nearest sample is taken, of the coarse field and then of the fine one; a
// sample clamped by the band's half-width is still a lower bound. So is the distance to the surface's box.

/// The indices of the samples nearest to a point along an axis, and its squared distances from them, in spacings.
struct NearestIndex {
  std::int32_t at;
  float off_sq;
};
STANDOFF_INLINE NearestIndex nearest_index(float x, float origin, float per_spacing, float last) {
  const float u = (x - origin) * per_spacing;
  const std::int32_t at = static_cast<std::int32_t>(min(max(u, 0.0f), last) + 0.5f);
  const float off = u - static_cast<float>(at);
  return {at, off * off};
}
STANDOFF_INLINE float outside_sq(const FieldView& f, int axis, float x) {
  const float out = max(max(f.min[axis] - x, x - f.max[axis]), 0.0f);
  return out * out;
}

/// The samples nearest to a sphere's centre, and their distances from it.
struct SphereSamples {
  float outside;               ///< the bound from the surface's box
  float coarse_off, fine_off;  ///< to be subtracted from the samples
  std::int32_t coarse;         ///< the coarse sample
  std::int32_t tile, within;   ///< the tile of the fine sample, and its index there
};

STANDOFF_INLINE SphereSamples samples_near(const FieldView& f, float x, float y, float z, float radius) {
  const auto coarse = [&f](int axis, float at) __attribute__((always_inline)) {
    return nearest_index(at, f.origin[axis], f.per_coarse_spacing, f.coarse_last[axis]);
  };
  const auto fine = [&f](int axis, float at) __attribute__((always_inline)) {
    return nearest_index(at, f.origin[axis], f.per_spacing, f.last[axis]);
  };
  const NearestIndex cx = coarse(0, x), cy = coarse(1, y), cz = coarse(2, z);
  const NearestIndex fx = fine(0, x), fy = fine(1, y), fz = fine(2, z);
  return {sqrt(outside_sq(f, 0, x) + outside_sq(f, 1, y) + outside_sq(f, 2, z)) - radius,
          sqrt(cx.off_sq + cy.off_sq + cz.off_sq) * f.coarse_spacing + radius,
          sqrt(fx.off_sq + fy.off_sq + fz.off_sq) * f.spacing + radius,
          coarse_index(f, cx.at, cy.at, cz.at),
          tile_of(f, fx.at, fy.at, fz.at),
          index_in_tile(fx.at, fy.at, fz.at)};
}

/// The gap of a sphere. If the coarse field's bound exceeds `enough`, the fine field is not sampled.
STANDOFF_INLINE float gap_of_sphere(const FieldView& f, float x, float y, float z, float radius, float enough) {
  const SphereSamples at = samples_near(f, x, y, z, radius);
  const float gap = max(at.outside, f.coarse[at.coarse] - at.coarse_off);
  if (gap > enough) return gap;
  return max(gap, static_cast<float>(fine_sample(f, at.tile, at.within)) * f.step - at.fine_off);
}

/// Coordinate `axis` of a transformed point.
STANDOFF_INLINE float transformed(const FloatTransform& transform, int axis, float x, float y, float z) {
  const float* const r = transform.rotation + 3 * axis;
  return r[0] * x + r[1] * y + r[2] * z + transform.translation[axis];
}

// Blocks of sixteen. Lanes without content hold an empty sphere or box.

inline constexpr int kLanes = Boxes16::kLanes;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct alignas(64) Sphere16 {
  float center[3][kLanes];
  float radius[kLanes];  ///< minus infinity for an empty sphere
};

/// An oriented box: all points center + sum of t_k axis[k] with |t_k| <= half[k]. Its axes are perpendicular unit
/// vectors up to the rounding to single precision; it holds what it is made for in spite of that.
struct Obb {
  float center[3], axis[3][3], half[3];
};

/// At least the length of an oriented box's axis, and so the factor by which its corners may be farther from the center
/// than its half diagonal: each coordinate is rounded by 2^-24, the rest is room.
inline constexpr double kAxisRoundUp = 1 + 0x1p-22;

/// Sixteen oriented boxes: center by coordinate, half by axis, axes by number and coordinate; then lane.
struct alignas(64) Obb16 {
  float center[3][kLanes], axis[3][3][kLanes], half[3][kLanes];

  STANDOFF_INLINE Obb lane(int n) const {
    Obb box;
    for (int k = 0; k < 3; ++k) {
      box.center[k] = center[k][n], box.half[k] = half[k][n];
      for (int j = 0; j < 3; ++j) box.axis[k][j] = axis[k][j][n];
    }
    return box;
  }
  void set(int n, const Obb& box) {
    for (int k = 0; k < 3; ++k) {
      center[k][n] = box.center[k], half[k][n] = box.half[k];
      for (int j = 0; j < 3; ++j) axis[k][j][n] = box.axis[k][j];
    }
  }
};

/// Sixteen triangles: corner, axis, lane.
struct alignas(64) Triangle16 {
  float corner[3][3][kLanes];
};

/// Pairs of triangles at a time: a 512-bit register holds this many doubles.
inline constexpr int kPairs = 8;

/// Eight pairs of triangles: corner, axis, lane.
struct alignas(64) TrianglePairs {
  double p[3][3][kPairs], q[3][3][kPairs];
};

/// The results of eight pairs: which of them intersect, and point, normal and depth as in Penetration.
struct alignas(64) PairOverlaps {
  double point[3][kPairs];
  double normal[3][kPairs];
  double depth[kPairs];
  std::uint32_t intersecting;  ///< bit n: pair n intersects for certain; otherwise its numbers are undefined
  std::uint32_t
      inaccurate;  ///< bit n: it intersects, but the errors of its numbers may exceed the promise of penetration()
  std::uint32_t unsure;  ///< bit n: rounding may hide the answer
};

/// The closest points of eight pairs that do not cross.
struct alignas(64) ClosestOfPairs {
  double distance_sq[kPairs];
  double on_p[3][kPairs], on_q[3][kPairs];
};

/// Prefetches all cache lines of an object.
template <class T>
inline void fetch(const T& what) {
  for (std::size_t line = 0; line < sizeof(T); line += 64)
    __builtin_prefetch(reinterpret_cast<const char*>(&what) + line);
}

/// Three perpendicular unit vectors in the frames of two bodies, and how far the center of a leaf of the second one is
/// from that of a leaf of the first one along each.
struct LeafAxes {
  float first[3][3], second[3][3], offset[3];
};

/// A triangle of one leaf and one of another, and what their squared distance is at least.
struct LeafPair {
  float distance_sq;
  std::uint8_t first, second;
};

/// An oriented box in double precision.
struct DoubleObb {
  Vec3 center, axis[3];
  double half[3];
};

/// Sixteen triangles in double precision: corner, axis, lane.
struct alignas(64) DoubleTriangles {
  double corner[3][3][kLanes];
};

/// The velocity of a rigid body at some time: linear + rotation x (p - center) at the point p. `center` moves at the
/// linear velocity.
struct RigidVelocity {
  Vec3 linear, rotation, center;
  double rate;  ///< the length of `rotation`, or a positive number next to 0
};

/// The axes of two leaves' boxes, and the line of their centers.
inline constexpr int kLeafAxes = 7;

/// Some of sixteen triangles, and their boxes.
struct TriangleSubset {
  const Triangle16* triangles;
  const Boxes16* boxes;
  std::uint32_t lanes;  ///< bits
};

/// A lane of one packet and one of another.
struct LanePair {
  std::uint8_t a, b;
};

}  // namespace standoff::collision
