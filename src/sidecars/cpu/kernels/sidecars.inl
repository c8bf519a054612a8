// SPDX-License-Identifier: Apache-2.0
// The kernel that makes sidecars of the nearest triangles of a tile, eight samples at once, in double. Coordinates are
// taken relative to each sample before anything else, so that nothing is lost far from the origin.
#pragma once

#include "geometry/closest_part.h"
#include "sidecars/cpu/kernels.h"
#include "simd/target.h"
#include "standoff/mesh.h"

namespace standoff::cpu::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

namespace {

constexpr int kSamplesAtOnce = WideDouble::kLanes;

// What a group of samples is loaded into, lane by lane.
struct SampleGroup {
  alignas(64) double corner[3][3][kSamplesAtOnce];
  alignas(64) double at[3][kSamplesAtOnce];
  alignas(64) double orientation[kSamplesAtOnce];
  alignas(64) double sign[kSamplesAtOnce];
  std::uint32_t sample[kSamplesAtOnce];
};

template <bool kPacked>
STANDOFF_INLINE void load_samples(const SidecarMesh& mesh, const SidecarTile& tile, const std::uint32_t* samples,
                                  int count, SampleGroup& group) {
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) {
    // Past the end the last one again, which changes nothing.
    const std::uint32_t n = samples[lane < count ? lane : count - 1], triangle = tile.nearest[n];
    group.at[0][lane] = tile.x[n % 8];
    group.at[1][lane] = tile.y[n / 8 % 8];
    group.at[2][lane] = tile.z[n / 64];
    for (int which = 0; which < 3; ++which) {
      double room[3];
      const double* v = corner_of<kPacked>(mesh.memory, triangle, which, room);
      for (int axis = 0; axis < 3; ++axis) group.corner[which][axis][lane] = v[axis];
    }
    group.sample[lane] = n;
    if (!tile.gradient) continue;
    const bool reversed = (mesh.use && mesh.use[triangle] < 0) != mesh.turned;
    group.orientation[lane] = !mesh.has_sign ? 0.0 : reversed ? -1.0 : 1.0;
    group.sign[lane] = mesh.has_negative && __builtin_signbit(tile.values[n]) ? -1.0 : 1.0;
  }
}

STANDOFF_INLINE Triple<WideDouble> load_three(const double (&from)[3][kSamplesAtOnce]) {
  return {WideDouble::load(from[0]), WideDouble::load(from[1]), WideDouble::load(from[2])};
}

// In a loop of its own, which the compiler makes wide.
STANDOFF_INLINE void store_rounded(const WideDouble& from, float* to) {
  alignas(64) double exact[kSamplesAtOnce];
  from.store(exact);
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) to[lane] = static_cast<float>(exact[lane]);
}

// Three numbers of each sample of the group.
STANDOFF_INLINE void store_triples(const Triple<WideDouble>& v, const SampleGroup& group, int count, float* out) {
  alignas(64) float x[kSamplesAtOnce], y[kSamplesAtOnce], z[kSamplesAtOnce];
  store_rounded(v.x, x);
  store_rounded(v.y, y);
  store_rounded(v.z, z);
  for (int lane = 0; lane < count; ++lane) {
    float* const to = out + 3 * group.sample[lane];
    to[0] = x[lane];
    to[1] = y[lane];
    to[2] = z[lane];
  }
}

int fill(const SidecarMesh& mesh, const SidecarTile& tile) {
  alignas(64) std::uint32_t samples[SidecarTile::kSamples + WideFloat::kLanes];
  int total = 0, near = 0;
  std::uint32_t wrong = 0;
  for (int n = 0; n < SidecarTile::kSamples; n += WideFloat::kLanes) {
    const WideUint triangle = WideUint::load(tile.nearest + n);
    const Mask has_one = less(triangle, WideUint(kNoTriangle)), exists = less(triangle, WideUint(mesh.triangles));
    wrong |= (has_one & ~exists).to_bits();
    total += store_packed(samples + total, has_one, WideUint(static_cast<std::uint32_t>(n)) + lane_numbers());
  }
  if (wrong != 0) return SidecarKernels::kNoSuchTriangle;
  SampleGroup group;
  for (int first = 0; first < total; first += kSamplesAtOnce) {
    const int count = total - first < kSamplesAtOnce ? total - first : kSamplesAtOnce;
    if (mesh.memory.packed)
      load_samples<true>(mesh, tile, samples + first, count, group);
    else
      load_samples<false>(mesh, tile, samples + first, count, group);
    const Triple<WideDouble> at = load_three(group.at);
    const WideDouble scale(mesh.scale);
    const Triple<WideDouble> a = (load_three(group.corner[0]) - at) * scale,
                             b = (load_three(group.corner[1]) - at) * scale,
                             c = (load_three(group.corner[2]) - at) * scale;
    const ClosestPart<WideDouble> part = closest_part(a, b, c);
    // Squares of squares are finite; where something overflowed, one of these is no number or infinite.
    const WideDouble most(0x1p200);
    if ((less(part.distance_sq, most) & less(part.side_sq, most)).to_bits() != 0xff) return SidecarKernels::kTooFar;
    if (tile.closest_point) store_triples(at + part.point * WideDouble(mesh.unscale), group, count, tile.closest_point);
    if (tile.barycentric) store_triples(part.weights, group, count, tile.barycentric);
    if (tile.feature) {
      alignas(64) double feature[kSamplesAtOnce];
      part.feature.store(feature);
      for (int lane = 0; lane < count; ++lane)
        tile.feature[group.sample[lane]] = static_cast<std::uint8_t>(feature[lane]);
    }
    if (tile.gradient) {
      const Slope<WideDouble> slope = slope_of(part, a, WideDouble::load(group.orientation));
      const DoubleMask is_near = less(WideDouble(0.5), slope.is_near);
      const WideDouble sign = select(is_near, WideDouble(1.0), WideDouble::load(group.sign));
      store_triples(slope.direction * sign, group, count, tile.gradient);
      near += __builtin_popcount(is_near.to_bits() & ((1u << count) - 1));
    }
  }
  return near;
}

}  // namespace

extern const SidecarKernels kSidecarKernels;
const SidecarKernels kSidecarKernels{.fill = fill};

}  // namespace standoff::cpu::STANDOFF_TARGET
