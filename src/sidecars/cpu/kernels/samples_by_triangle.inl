// SPDX-License-Identifier: Apache-2.0
// The samples of a tile that have a nearest triangle: those of one triangle together, so that it is prepared once.
#pragma once

#include "sidecars/cpu/kernels.h"
#include "simd/target.h"
#include "standoff/mesh.h"

namespace standoff::cpu::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

namespace {

constexpr int kSamplesAtOnce = WideDouble::kLanes;

// Samples of a tile, with as many more as the last group reads.
struct Samples {
  alignas(64) std::uint32_t at[SidecarTile::kSamples + WideFloat::kLanes];
  int count = 0;

  void add(std::uint32_t sample) { at[count++] = sample; }
};

// Calls use(eight samples, how many) for each group of some samples: past the end, the last one again.
template <class Use>
STANDOFF_INLINE void for_each_group(const std::uint32_t* samples, int count, const Use& use) {
  int first = 0;
  for (; first + kSamplesAtOnce <= count; first += kSamplesAtOnce) use(samples + first, kSamplesAtOnce);
  if (first == count) return;
  std::uint32_t last[kSamplesAtOnce];
  for (int n = 0; n < kSamplesAtOnce; ++n) last[n] = samples[first + n < count ? first + n : count - 1];
  use(last, count - first);
}

// Triangles and the samples that they are nearest to: those of triangle n are samples.at[first[n]] up to
// samples.at[first[n + 1]].
struct SamplesByTriangle {
  std::uint32_t triangle[SidecarTile::kSamples];
  int first[SidecarTile::kSamples + 1];
  int triangles = 0;
  Samples samples;  // and past the end, the last one again, as often as a group reads it
  Samples others;   // that are not among these, or not over the inside of their triangle
};

// Those with a nearest triangle, and these. Returns whether the mesh has all of them.
STANDOFF_INLINE bool find_samples(const SidecarMesh& mesh, const SidecarTile& tile, Samples& samples,
                                  std::uint32_t* nearest) {
  std::uint32_t wrong = 0;
  int count = 0;
  for (int n = 0; n < SidecarTile::kSamples; n += WideFloat::kLanes) {
    const WideUint triangle = WideUint::load(tile.nearest + n);
    const Mask has_one = less(triangle, WideUint(kNoTriangle)), exists = less(triangle, WideUint(mesh.triangles));
    wrong |= (has_one & ~exists).to_bits();
    store_packed(nearest + count, has_one, triangle);
    count += store_packed(samples.at + count, has_one, WideUint(static_cast<std::uint32_t>(n)) + lane_numbers());
  }
  samples.count = count;
  return wrong == 0;
}

// Sorts the samples by triangle as long as that pays: it takes a look at all samples for each triangle. Returns whether
// the mesh has all of these triangles.
STANDOFF_INLINE bool sort_by_triangle(const SidecarMesh& mesh, const SidecarTile& tile, SamplesByTriangle& sorted) {
  constexpr int kLanes = WideFloat::kLanes;
  constexpr int kTriangles = 8, kLeastSamples = 5;  // stops where these triangles or more have fewer samples each
  alignas(64) std::uint32_t nearest[SidecarTile::kSamples + kLanes];
  Samples all;
  if (!find_samples(mesh, tile, all, nearest)) return false;
  const int vectors = (all.count + kLanes - 1) / kLanes;
  std::uint32_t left[SidecarTile::kSamples / kLanes];
  for (int v = 0; v < vectors; ++v) left[v] = 0xffff;
  if (all.count % kLanes != 0) left[vectors - 1] = (1u << all.count % kLanes) - 1;
  const auto move = [&](int v, std::uint32_t which, Samples& to) __attribute__((always_inline)) {
    left[v] ^= which;
    to.count += store_packed(to.at + to.count, mask_from_bits(which), WideUint::load(all.at + v * kLanes));
  };
  Samples& samples = sorted.samples;
  const auto pays = [&] { return sorted.triangles < kTriangles || samples.count >= kLeastSamples * sorted.triangles; };
  sorted.first[0] = 0;
  for (int v = 0; v < vectors; ++v) {
    while (left[v] != 0 && pays()) {
      const std::uint32_t triangle = nearest[v * kLanes + __builtin_ctz(left[v])];
      prefetch_indices(mesh.memory, triangle);
      for (int other = v; other < vectors; ++other)
        move(other, equal(WideUint::load(nearest + other * kLanes), WideUint(triangle)).to_bits() & left[other],
             samples);
      sorted.triangle[sorted.triangles++] = triangle;
      sorted.first[sorted.triangles] = samples.count;
    }
    move(v, left[v], sorted.others);
  }
  for (int n = 0; n < kSamplesAtOnce && samples.count > 0; ++n)
    samples.at[samples.count + n] = samples.at[samples.count - 1];
  return true;
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
