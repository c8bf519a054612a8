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
  alignas(64) double corner[3][3][kSamplesAtOnce];  // relative to the sample, scaled
  alignas(64) double orientation[kSamplesAtOnce];
  alignas(64) double sign[kSamplesAtOnce];
  std::uint32_t sample[kSamplesAtOnce];
};

template <bool kPacked>
STANDOFF_INLINE void load_samples(const SidecarMesh& mesh, const SidecarTile& tile, const std::uint16_t* samples,
                                  int count, SampleGroup& group) {
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) {
    // Past the end the last one again, which changes nothing.
    const std::uint32_t n = samples[lane < count ? lane : count - 1], triangle = tile.nearest[n];
    const double at[3] = {tile.x[n % 8], tile.y[n / 8 % 8], tile.z[n / 64]};
    for (int which = 0; which < 3; ++which) {
      double room[3];
      const double* v = corner_of<kPacked>(mesh.memory, triangle, which, room);
      for (int axis = 0; axis < 3; ++axis) group.corner[which][axis][lane] = (v[axis] - at[axis]) * mesh.scale;
    }
    group.sample[lane] = n;
    if (!tile.gradient) continue;
    const bool reversed = (mesh.use && mesh.use[triangle] < 0) != mesh.turned;
    group.orientation[lane] = !mesh.has_sign ? 0.0 : reversed ? -1.0 : 1.0;
    group.sign[lane] = mesh.has_negative && __builtin_signbit(tile.values[n]) ? -1.0 : 1.0;
  }
}

STANDOFF_INLINE Triple<WideDouble> load_corner(const SampleGroup& group, int which) {
  return {WideDouble::load(group.corner[which][0]), WideDouble::load(group.corner[which][1]),
          WideDouble::load(group.corner[which][2])};
}

// Three numbers of each sample of the group.
STANDOFF_INLINE void store_triples(const Triple<WideDouble>& v, const SampleGroup& group, int count, float* out) {
  alignas(64) double x[kSamplesAtOnce], y[kSamplesAtOnce], z[kSamplesAtOnce];
  v.x.store(x);
  v.y.store(y);
  v.z.store(z);
  for (int lane = 0; lane < count; ++lane) {
    float* const to = out + 3 * group.sample[lane];
    to[0] = static_cast<float>(x[lane]);
    to[1] = static_cast<float>(y[lane]);
    to[2] = static_cast<float>(z[lane]);
  }
}

STANDOFF_INLINE Triple<WideDouble> positions(const SidecarTile& tile, const SampleGroup& group) {
  alignas(64) double at[3][kSamplesAtOnce];
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) {
    const std::uint32_t n = group.sample[lane];
    at[0][lane] = tile.x[n % 8];
    at[1][lane] = tile.y[n / 8 % 8];
    at[2][lane] = tile.z[n / 64];
  }
  return {WideDouble::load(at[0]), WideDouble::load(at[1]), WideDouble::load(at[2])};
}

int fill(const SidecarMesh& mesh, const SidecarTile& tile) {
  std::uint16_t samples[SidecarTile::kSamples];
  int total = 0, near = 0;
  for (int n = 0; n < SidecarTile::kSamples; ++n) {
    samples[total] = static_cast<std::uint16_t>(n);
    total += tile.nearest[n] != kNoTriangle;
  }
  SampleGroup group;
  for (int first = 0; first < total; first += kSamplesAtOnce) {
    const int count = total - first < kSamplesAtOnce ? total - first : kSamplesAtOnce;
    if (mesh.memory.packed)
      load_samples<true>(mesh, tile, samples + first, count, group);
    else
      load_samples<false>(mesh, tile, samples + first, count, group);
    const Triple<WideDouble> a = load_corner(group, 0), b = load_corner(group, 1), c = load_corner(group, 2);
    const ClosestPart<WideDouble> part = closest_part(a, b, c);
    if (tile.closest_point)
      store_triples(positions(tile, group) + part.point * WideDouble(mesh.unscale), group, count, tile.closest_point);
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
