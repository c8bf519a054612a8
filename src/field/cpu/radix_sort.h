// SPDX-License-Identifier: Apache-2.0
// Sorts indices by 32-bit keys: a stable radix sort in parallel chunks, the same result for any number of threads.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/threads.h"

namespace standoff::cpu {

struct KeyedIndex {
  std::uint32_t key;
  std::uint32_t index;
};

inline constexpr int kRadixBits = 11;
using RadixCounters = std::array<std::uint32_t, std::size_t{1} << kRadixBits>;

inline std::int64_t radix_sort_chunks(std::int64_t size, int threads) {
  return std::clamp<std::int64_t>(size / 16384, 1, std::int64_t{4} * threads);
}

/// Bytes of so many items while they are sorted.
inline std::int64_t radix_sort_bytes(std::int64_t size, int threads) {
  return 2 * size * static_cast<std::int64_t>(sizeof(KeyedIndex)) +
         radix_sort_chunks(size, threads) * static_cast<std::int64_t>(sizeof(RadixCounters));
}

/// `Items`: a vector of KeyedIndex.
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
    items.swap(sorted);
  }
}

}  // namespace standoff::cpu
