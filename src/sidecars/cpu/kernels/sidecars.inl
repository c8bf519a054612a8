// SPDX-License-Identifier: Apache-2.0
// The kernel that makes sidecars of the nearest triangles of a tile, eight samples at once, in double: first for all by
// regions, then again, with more care, for those where that says nothing.
#pragma once

#include "geometry/closest_part.h"
#include "geometry/quick_part.h"
#include "sidecars/cpu/kernels/sample_groups.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// Samples of a tile, with as many more that the last group reads.
struct Samples {
  alignas(64) std::uint32_t at[SidecarTile::kSamples + WideFloat::kLanes];
  int count = 0;

  void add(std::uint32_t sample) { at[count++] = sample; }
  // Calls use(samples, how many) for each group: past the end, the last sample again.
  template <class Use>
  STANDOFF_INLINE void for_each_group(const Use& use) {
    for (int n = 0; n < kSamplesAtOnce && count != 0; ++n) at[count + n] = at[count - 1];
    for (int first = 0; first < count; first += kSamplesAtOnce)
      use(at + first, count - first < kSamplesAtOnce ? count - first : kSamplesAtOnce);
  }
};

// Those with a nearest triangle. Returns whether the mesh has all of these.
STANDOFF_INLINE bool find_samples(const SidecarMesh& mesh, const SidecarTile& tile, Samples& samples) {
  std::uint32_t wrong = 0;
  for (int n = 0; n < SidecarTile::kSamples; n += WideFloat::kLanes) {
    const WideUint triangle = WideUint::load(tile.nearest + n);
    const Mask has_one = less(triangle, WideUint(kNoTriangle)), exists = less(triangle, WideUint(mesh.triangles));
    wrong |= (has_one & ~exists).to_bits();
    samples.count +=
        store_packed(samples.at + samples.count, has_one, WideUint(static_cast<std::uint32_t>(n)) + lane_numbers());
  }
  return wrong == 0;
}

// Fills the outputs of all samples, and lists those whose answers are not sound (geometry/quick_part.h).
template <bool kPacked>
STANDOFF_INLINE void fill_quickly(const SidecarMesh& mesh, const SidecarTile& tile, const ScaledPlaces& places,
                                  Samples& samples, Samples& poor) {
  samples.for_each_group([&](const std::uint32_t* some, int count) __attribute__((always_inline)) {
    DoublePoint corner[3];
    load_corners<kPacked>(mesh, tile, places, some, corner);
    QuickPart<WideDouble> part;
    const std::uint32_t sound = quick_part(corner[0], corner[1], corner[2], part).to_bits();
    store_part(part, mesh, tile, some, count);
    if (tile.gradient)
      store_triples(part.point * (-gradient_signs(mesh, tile, some) / sqrt(part.distance_sq)), some, count,
                    tile.gradient);
    for (std::uint32_t left = ~sound & ((1u << count) - 1); left != 0; left &= left - 1)
      poor.add(some[__builtin_ctz(left)]);
  });
}

STANDOFF_INLINE WideDouble orientations(const SidecarMesh& mesh, const SidecarTile& tile,
                                        const std::uint32_t* samples) {
  alignas(64) double orientation[kSamplesAtOnce];
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) {
    const bool reversed = (mesh.use && mesh.use[tile.nearest[samples[lane]]] < 0) != mesh.turned;
    orientation[lane] = !mesh.has_sign ? 0.0 : reversed ? -1.0 : 1.0;
  }
  return WideDouble::load(orientation);
}

// The same for any triangles. Returns how many samples are on the surface, or kTooFar.
template <bool kPacked>
STANDOFF_INLINE int fill_exactly(const SidecarMesh& mesh, const SidecarTile& tile, const ScaledPlaces& places,
                                 Samples& samples) {
  int near = 0;
  bool too_far = false;
  samples.for_each_group([&](const std::uint32_t* some, int count) __attribute__((always_inline)) {
    DoublePoint corner[3];
    load_corners<kPacked>(mesh, tile, places, some, corner);
    const ClosestPart<WideDouble> part = closest_part(corner[0], corner[1], corner[2]);
    // Squares of squares are finite; where something overflowed, one of these is no number or infinite.
    const WideDouble most(0x1p200);
    too_far |= (less(part.distance_sq, most) & less(part.side_sq, most)).to_bits() != 0xff;
    store_part(part, mesh, tile, some, count);
    if (!tile.gradient) return;
    const Slope<WideDouble> slope = slope_of(part, corner[0], orientations(mesh, tile, some));
    const DoubleMask is_near = less(WideDouble(0.5), slope.is_near);
    const WideDouble sign = select(is_near, WideDouble(1.0), gradient_signs(mesh, tile, some));
    store_triples(slope.direction * sign, some, count, tile.gradient);
    near += __builtin_popcount(is_near.to_bits() & ((1u << count) - 1));
  });
  return too_far ? SidecarKernels::kTooFar : near;
}

template <bool kPacked>
STANDOFF_INLINE int fill_found(const SidecarMesh& mesh, const SidecarTile& tile, Samples& samples) {
  ScaledPlaces places;
  set_places(mesh, tile, places);
  Samples poor;
  fill_quickly<kPacked>(mesh, tile, places, samples, poor);
  return fill_exactly<kPacked>(mesh, tile, places, poor);
}

int fill(const SidecarMesh& mesh, const SidecarTile& tile) {
  Samples samples;
  if (!find_samples(mesh, tile, samples)) return SidecarKernels::kNoSuchTriangle;
  return mesh.memory.packed ? fill_found<true>(mesh, tile, samples) : fill_found<false>(mesh, tile, samples);
}

}  // namespace

extern const SidecarKernels kSidecarKernels;
const SidecarKernels kSidecarKernels{.fill = fill};

}  // namespace standoff::cpu::STANDOFF_TARGET
