// SPDX-License-Identifier: Apache-2.0
// Orders of triangles in which neighbours are near each other: what the nodes of a BVH are cut from (bvh.h). And the
// sort by which one of them is made.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "core/threads.h"
#include "standoff/mesh.h"

namespace standoff {

// Sorts indices by 32-bit keys: a stable radix sort in parallel chunks, the same result for any number of threads.

struct KeyedIndex {
  std::uint32_t key;
  std::uint32_t index;
};

inline constexpr int kRadixBits = 11;
using RadixCounters = std::array<std::uint32_t, std::size_t{1} << kRadixBits>;

inline std::int64_t radix_sort_chunks(std::int64_t size, int threads) {
  return std::clamp<std::int64_t>(size / 16384, 1, std::int64_t{4} * threads);
}

/// The bytes of `size` items while they are sorted.
inline std::int64_t radix_sort_bytes(std::int64_t size, int threads) {
  return 2 * size * static_cast<std::int64_t>(sizeof(KeyedIndex)) +
         radix_sort_chunks(size, threads) * static_cast<std::int64_t>(sizeof(RadixCounters));
}

/// `Items`: an array of KeyedIndex. Runs on the threads of the calling TBB arena.
template <class Items>
inline void radix_sort(Items& items, int threads) {
  constexpr std::uint32_t kBuckets = 1u << kRadixBits;
  const auto size = static_cast<std::int64_t>(items.size());
  const std::int64_t chunks = radix_sort_chunks(size, threads);
  Items sorted(items.size());
  std::vector<RadixCounters> positions(static_cast<std::size_t>(chunks));
  for (int shift = 0; shift < 32; shift += kRadixBits) {
    const auto bucket = [shift](const KeyedIndex& item) { return item.key >> shift & (kBuckets - 1); };
    tbb::parallel_for(std::int64_t{0}, chunks, [&](std::int64_t chunk) {
      positions[chunk].fill(0);
      for (std::int64_t n = size * chunk / chunks; n < size * (chunk + 1) / chunks; ++n)
        ++positions[chunk][bucket(items[n])];
    });
    places_from_counts(positions, kBuckets, [](std::size_t, std::uint32_t) {});
    tbb::parallel_for(std::int64_t{0}, chunks, [&](std::int64_t chunk) {
      for (std::int64_t n = size * chunk / chunks; n < size * (chunk + 1) / chunks; ++n)
        sorted[positions[chunk][bucket(items[n])]++] = items[n];
    });
    std::swap(items, sorted);
  }
}

// The orders. Both are the same for any number of threads, run on those of the calling TBB arena, and throw
// Error{interrupted} when the progress ends them. `among`: ascending indices into mesh.triangles; empty: all of them.

/// Triangles along a Morton curve through the middles of their boxes, 2^10 cells along the longest side of them all;
/// by index in one cell. Quick to make: for a BVH that is asked once.
std::vector<std::uint32_t> morton_order(MeshView mesh, std::span<const std::uint32_t> among, ProgressMeter& progress);

/// A triangle by its middle.
struct TriangleCenter {
  std::array<float, 3> at;
  std::uint32_t triangle;
};

/// Triangles by halving: all are split across the longest side of the box of their centers into two halves of whole
/// nodes, the halves again, and so on down to single nodes of sixteen. That takes longer than the curve, but boxes are
/// tighter, and a search for one point visits half as many nodes: for a BVH that is asked many times.
std::vector<std::uint32_t> halving_order(std::span<TriangleCenter> centers, ProgressMeter& progress);
/// The same of the middles of the triangles' boxes, in the cube [0, 1]^3 around them all.
std::vector<std::uint32_t> halving_order(MeshView mesh, std::span<const std::uint32_t> among, ProgressMeter& progress);

}  // namespace standoff
