// SPDX-License-Identifier: Apache-2.0
// Orders of triangles in which neighbours are near each other, and the hierarchy of boxes that is cut from such an
// order: what coarse cells look at instead of triangles.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/threads.h"
#include "field/backend.h"
#include "field/cpu/kernels.h"

namespace standoff::cpu {

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

// Orders of triangles: what packs of sixteen are cut from.

/// The mesh indices of a job's triangles along a Morton curve: quick to make, for a hierarchy that serves one field. As
/// those below, the same for any number of threads. Runs on the threads of the calling TBB arena.
std::vector<std::uint32_t> morton_order(const Job& job);

/// The same by halving: all triangles are split across the longest side of their centers' box into two halves of whole
/// packs, the halves again, and so on down to single packs. That takes longer. The packs have tighter
/// boxes, and a search for one point visits half as many: for a hierarchy that is asked many times.
std::vector<std::uint32_t> halving_order(const Job& job);

// Triangles in groups of neighbours, groups of groups, and a box around each.

/// A hierarchy of boxes without pointers: triangles in an order (above) and packed by sixteen, packs packed
/// by sixteen, and so on. An entry of a list is a triangle, by its place in the order (below triangles()), or from
/// there on a whole pack. Boxes are in float, grid units relative to the centre of the grid, rounded outwards and a
/// little more, so that they cover what later subtractions in float lose.
class Clusters {
 public:
  static constexpr int kFanout = kLanes;

  /// `order`: the mesh indices of the job's triangles.
  Clusters(const Job& job, const BlockLattice& lattice, std::vector<std::uint32_t> order);

  /// How many entries there are, triangles and packs.
  std::int64_t entries() const { return std::int64_t{triangles_} + level_begin_.back(); }
  /// The same of so many triangles.
  static std::int64_t entries_of(std::int64_t triangles);
  /// Bytes held while they are made, on so many threads, which are more than those held afterwards.
  static std::int64_t bytes(std::int64_t triangles, int threads);

  /// The mesh index of an entry that is a triangle.
  std::uint32_t triangle(std::uint32_t entry) const { return order_[entry]; }
  /// The same of all entries that are triangles, and a point of each, as exact as the boxes and in their coordinates.
  const std::uint32_t* indices() const { return order_.data(); }
  const float (*points() const)[3] { return points_.get(); }
  bool is_pack(std::uint32_t entry) const { return entry >= triangles_; }
  /// All packs, and the first one of each level; after the last level, the end.
  const BoxPack* packs() const { return packs_.get(); }
  const std::vector<std::uint32_t>& level_begin() const { return level_begin_; }
  /// The pack that holds all others.
  std::uint32_t top() const { return triangles_ + level_begin_.back() - 1; }

  /// How many triangles an entry stands for, at most: the last pack of a level may hold fewer.
  std::int64_t triangles_in(std::uint32_t entry) const {
    return is_pack(entry) ? std::int64_t{kFanout} << 4 * level_of(entry - triangles_) : 1;
  }
  /// What the pack that an entry stands for holds.
  PackContents contents(std::uint32_t entry) const;
  /// Asks the memory for the boxes of a pack that will be looked at soon.
  void prefetch(std::uint32_t entry) const {
    const char* pack = reinterpret_cast<const char*>(&packs_[entry - triangles_]);
    for (std::size_t line = 0; line < sizeof(BoxPack); line += 64) __builtin_prefetch(pack + line);
  }
  /// Of the grid, world units times scale.
  const double (&center() const)[3] { return center_; }
  /// Half the longest side of the grid.
  float extent() const { return extent_; }

 private:
  static_assert(kFanout == 1 << 4);
  std::size_t level_of(std::uint32_t pack) const {
    std::size_t level = 0;
    while (pack >= level_begin_[level + 1]) ++level;
    return level;
  }
  float slack_at(float coordinate) const;
  void box_triangles();
  void box_packs();

  const Job& job_;
  const BlockLattice& lattice_;
  double center_[3];
  float extent_ = 0;
  std::uint32_t triangles_ = 0;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> level_begin_;  // the first pack of each level, those of triangles first; and the end
  std::unique_ptr<BoxPack[]> packs_;
  std::unique_ptr<float[][3]> points_;
};

}  // namespace standoff::cpu
