// SPDX-License-Identifier: Apache-2.0
// The tree of OpenVDB and NanoVDB: leaves of 8^3 samples, which are our tiles, in nodes of 16^3 of them, in nodes of
// 32^3 of those, in a root without bounds. Within a node z is the fastest axis.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include "core/threads.h"
#include "files/atomic_file.h"
#include "io/field/vdb_tree.h"
#include "standoff/field.h"
#include "standoff/io.h"

namespace standoff::vdb {

inline constexpr int kLeafSide = 8, kLowerSide = 128, kUpperSide = 4096;  ///< in samples
inline constexpr int kLeafLog = 3, kLowerLog = 4, kUpperLog = 5;          ///< of a node's children per axis

/// A bit for each child or sample of a node of 2^log per axis.
template <int log>
struct Mask {
  static constexpr std::size_t kBits = std::size_t{1} << 3 * log;
  std::array<std::uint64_t, kBits / 64> words{};

  bool operator[](std::size_t n) const { return words[n / 64] >> n % 64 & 1; }
  void set(std::size_t n) { words[n / 64] |= std::uint64_t{1} << n % 64; }
  std::size_t count() const {
    std::size_t sum = 0;
    for (const std::uint64_t word : words) sum += static_cast<std::size_t>(__builtin_popcountll(word));
    return sum;
  }
  bool none() const {
    for (const std::uint64_t word : words)
      if (word != 0) return false;
    return true;
  }
  std::span<const std::byte> bytes() const { return std::as_bytes(std::span(words)); }
};

/// A child's place in its node, in children, by its number: z counts fastest.
template <int log>
constexpr Size3 child_place(std::size_t n) {
  constexpr std::size_t kLast = (std::size_t{1} << log) - 1;
  return {static_cast<std::int64_t>(n >> 2 * log), static_cast<std::int64_t>(n >> log & kLast),
          static_cast<std::int64_t>(n & kLast)};
}

/// Sample n of a leaf is this sample of a tile, whose fastest axis is x.
constexpr std::size_t tile_sample(std::size_t n) { return (n & 7) << 6 | (n & 0x38) | n >> 6; }

/// A node whose children are nodes, or tiles that are inside; all else is outside.
template <int log>
struct Node {
  Size3 at;  ///< its first sample
  Mask<log> child, inside;
  std::size_t first = 0, count = 0;  ///< its children among the nodes of the next level
};

/// The nodes that a field needs, level by level, each level in the order of the one above. What is inside throughout is
/// one tile of the highest level it fills.
struct Tree {
  struct Leaf {
    Size3 at;
    std::int32_t slot;  ///< of the tile
  };
  std::vector<Size3> inside;  ///< tiles of the root
  std::vector<Node<kUpperLog>> uppers;
  std::vector<Node<kLowerLog>> lowers;
  std::vector<Leaf> leaves;
};
/// Of the field that is to be written to `file`, whose caller may stop it.
Tree tree_of(const DistanceField& field, const AtomicFile& file);

/// Which samples of a leaf are in the band, nearer than the thickness, and the range of their values.
struct LeafMasks {
  Mask<kLeafLog> active, outside;                ///< those that are neither are inside
  bool any_inside = false, any_outside = false;  ///< of those that are not active
  float least, most;                             ///< of those that are; least > most if none is
};
LeafMasks leaf_masks(const DistanceField& field, const Tree::Leaf& leaf);
/// The values of a leaf. `far` replaces the thickness, which may be infinite.
void leaf_values(const DistanceField& field, const Tree::Leaf& leaf, float far, std::array<float, 512>& values);
/// Fetches the tile of the leaf after leaf n into the cache while leaf n is worked on: leaves that follow one another
/// lie anywhere in memory.
void fetch_leaf_after(const DistanceField& field, const Tree& tree, std::size_t n);

/// The value of what is not stored, in a file: the thickness, or a finite number beyond all values where it is
/// infinite.
float background_of(const DistanceField& field);
/// Throws Error{usage} unless all samples have indices of 32 bits.
void check_indices(const DistanceField& field, const char* format);

/// Calls make(n, to) for each leaf, which writes at most `most` bytes there and returns how many they are. Some are
/// made while others are written.
template <class Make>
void write_leaves(AtomicFile& file, const Tree& tree, int threads, std::size_t most, const Make& make) {
  constexpr std::size_t kAtOnce = 512;  // two megabytes in all, which stay in the cache
  const std::size_t all = tree.leaves.size();
  struct Part {
    std::vector<char> bytes;
    std::vector<std::size_t> lengths;
    std::size_t first = 0, count = 0;
  };
  std::array<Part, 2> parts;
  for (Part& part : parts) {
    part.bytes.resize(most * std::min(kAtOnce, all));
    part.lengths.resize(std::min(kAtOnce, all));
  }
  const auto fill = [&](Part& part, std::size_t first) {
    part.first = std::min(first, all);
    part.count = std::min(kAtOnce, all - part.first);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part.count, 16), [&](const auto& range) {
      for (std::size_t n = range.begin(); n < range.end(); ++n)
        part.lengths[n] = make(part.first + n, part.bytes.data() + most * n);
    });
  };
  const auto write = [&](const Part& part) {
    for (std::size_t n = 0; n < part.count;) {
      const std::size_t first = n;
      std::size_t bytes = part.lengths[n++];
      // At once those without gaps between them.
      while (n < part.count && bytes == most * (n - first)) bytes += part.lengths[n++];
      file.write(part.bytes.data() + most * first, bytes);
    }
  };
  Threads(threads).run([&] {
    fill(parts[0], 0);
    for (std::size_t n = 0; parts[n].count > 0; n = 1 - n)
      tbb::parallel_invoke([&] { write(parts[n]); }, [&] { fill(parts[1 - n], parts[n].first + kAtOnce); });
  });
}

/// Calls use(n) for each leaf, on all threads.
template <class Use>
void each_leaf(const Tree& tree, int threads, const Use& use) {
  Threads(threads).run([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tree.leaves.size(), 64), [&](const auto& range) {
      for (std::size_t n = range.begin(); n < range.end(); ++n) use(n);
    });
  });
}

}  // namespace standoff::vdb
