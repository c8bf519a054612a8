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
  Samples samples;
  Samples others;  // of triangles that have few each
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

// How often a sample's triangle is not that of the one before.
STANDOFF_INLINE int changes_of(const std::uint32_t* nearest, int count) {
  constexpr int kLanes = WideFloat::kLanes;
  int changes = 0;
  for (int n = 1; n < count; n += kLanes) {
    const std::uint32_t used = count - n < kLanes ? (1u << (count - n)) - 1 : 0xffffu;
    const std::uint32_t same = equal(WideUint::load(nearest + n - 1), WideUint::load(nearest + n)).to_bits();
    changes += __builtin_popcount(~same & used);
  }
  return changes;
}

// Sorts the samples by triangle where that pays: it takes a look at all samples for each triangle. Returns whether the
// mesh has all of these triangles.
STANDOFF_INLINE bool sort_by_triangle(const SidecarMesh& mesh, const SidecarTile& tile, SamplesByTriangle& sorted) {
  constexpr int kLanes = WideFloat::kLanes, kLongRun = 2;
  alignas(64) std::uint32_t nearest[SidecarTile::kSamples + kLanes];
  Samples& all = sorted.others;
  if (!find_samples(mesh, tile, all, nearest)) return false;
  sorted.first[0] = 0;
  const int count = all.count;
  if (changes_of(nearest, count) * kLongRun > count) return true;
  all.count = 0;  // they all go elsewhere
  const int vectors = (count + kLanes - 1) / kLanes;
  std::uint32_t left[SidecarTile::kSamples / kLanes];
  for (int v = 0; v < vectors; ++v) left[v] = 0xffff;
  if (count % kLanes != 0) left[vectors - 1] = (1u << count % kLanes) - 1;
  int end = 0;
  for (int v = 0; v < vectors; ++v)
    while (left[v] != 0) {
      const WideUint triangle(nearest[v * kLanes + __builtin_ctz(left[v])]);
      sorted.triangle[sorted.triangles] = nearest[v * kLanes + __builtin_ctz(left[v])];
      for (int other = v; other < vectors; ++other) {
        const std::uint32_t same = equal(WideUint::load(nearest + other * kLanes), triangle).to_bits() & left[other];
        left[other] ^= same;
        end += store_packed(sorted.samples.at + end, mask_from_bits(same), WideUint::load(all.at + other * kLanes));
      }
      sorted.first[++sorted.triangles] = end;
    }
  return true;
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
