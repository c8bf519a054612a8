// SPDX-License-Identifier: Apache-2.0
// Sets of samples of a tile, one bit each, with the steps from sample to sample along its edges; and sets of tiles.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sign/signs.h"

namespace standoff {

/// A set of samples of a tile: a word for each z, in which sample (x, y) is bit x + 8 y.
using TileBits = std::array<std::uint64_t, 8>;

/// For each axis, the samples from which the edge to the next sample is crossed.
struct TileEdges {
  std::array<TileBits, 3> crossed{};
};
inline constexpr TileEdges kNoEdges{};

inline constexpr std::uint64_t kFirstX = 0x0101010101010101, kLastX = kFirstX << 7;
inline constexpr std::uint64_t kFirstY = 0xff, kLastY = kFirstY << 56;
inline constexpr TileBits kAllBits = [] {
  TileBits all{};
  for (std::uint64_t& word : all) word = ~std::uint64_t{0};
  return all;
}();

inline TileBits operator~(TileBits bits) {
  for (std::uint64_t& word : bits) word = ~word;
  return bits;
}
inline TileBits operator|(TileBits a, const TileBits& b) {
  for (std::size_t z = 0; z < a.size(); ++z) a[z] |= b[z];
  return a;
}
inline TileBits operator&(TileBits a, const TileBits& b) {
  for (std::size_t z = 0; z < a.size(); ++z) a[z] &= b[z];
  return a;
}
inline bool any(const TileBits& bits) {
  std::uint64_t some = 0;
  for (const std::uint64_t word : bits) some |= word;
  return some != 0;
}
inline int count(const TileBits& bits) {
  int sum = 0;
  for (const std::uint64_t word : bits) sum += std::popcount(word);
  return sum;
}

/// The samples together with their neighbours along edges within the tile that are not crossed.
inline TileBits with_neighbours(const TileBits& from, const TileEdges& edges) {
  const auto& [along_x, along_y, along_z] = edges.crossed;
  TileBits to = from;
  for (std::size_t z = 0; z < 8; ++z) {
    const std::uint64_t word = from[z];
    to[z] |= (word & ~along_x[z] & ~kLastX) << 1 | (word >> 1 & ~along_x[z] & ~kLastX) | (word & ~along_y[z]) << 8 |
             (word >> 8 & ~along_y[z]);
    if (z + 1 == 8) continue;
    to[z + 1] |= word & ~along_z[z];
    to[z] |= from[z + 1] & ~along_z[z];
  }
  return to;
}

/// A face of a tile, towards its neighbour along `axis`, upwards or downwards.
struct Face {
  std::size_t axis;
  bool up;
};
inline constexpr std::array<Face, 6> kFaces = {{{0, true}, {0, false}, {1, true}, {1, false}, {2, true}, {2, false}}};

/// The samples of the tile beyond a face that samples of this tile reach by an edge that is not crossed. `lower`: the
/// edges of the lower tile of both, to which the edges between them belong.
inline TileBits beyond(const TileBits& from, Face face, const TileEdges& lower) {
  const TileBits& crossed = lower.crossed[face.axis];
  TileBits to{};
  for (std::size_t z = 0; z < 8; ++z) {
    if (face.axis == 0)
      to[z] = face.up ? (from[z] & ~crossed[z] & kLastX) >> 7 : (from[z] & kFirstX) << 7 & ~crossed[z];
    if (face.axis == 1)
      to[z] = face.up ? (from[z] & ~crossed[z] & kLastY) >> 56 : (from[z] & kFirstY) << 56 & ~crossed[z];
  }
  if (face.axis == 2) (face.up ? to[0] : to[7]) = (face.up ? from[7] : from[0]) & ~crossed[7];
  return to;
}

/// Marks samples of tile tx as inside. Requires samples within the grid, and rows that were cleared.
inline void mark(InsideRows& rows, std::int64_t tx, const TileBits& inside) {
  const auto tile = rows.tile(tx);
  for (std::size_t row = 0; row < tile.size(); ++row)
    tile[row] = static_cast<std::uint8_t>(inside[row / 8] >> 8 * (row % 8));
}

/// The samples of a tile that are within a grid of this size.
inline TileBits bits_in_grid(const Size3& size, const std::array<std::int64_t, 3>& tile) {
  const auto first = [](std::int64_t n) { return n < 64 ? (std::uint64_t{1} << n) - 1 : ~std::uint64_t{0}; };
  const auto within = [](std::int64_t samples, std::int64_t at) { return std::min<std::int64_t>(8, samples - 8 * at); };
  const std::uint64_t slice = first(within(size.x, tile[0])) * kFirstX & first(8 * within(size.y, tile[1]));
  TileBits bits{};
  for (std::int64_t z = 0; z < within(size.z, tile[2]); ++z) bits[static_cast<std::size_t>(z)] = slice;
  return bits;
}

/// The samples of a tile at a face.
inline TileBits at_face(Face face) {
  TileBits bits{};
  for (std::size_t z = 0; z < 8; ++z) {
    if (face.axis == 0) bits[z] = face.up ? kLastX : kFirstX;
    if (face.axis == 1) bits[z] = face.up ? kLastY : kFirstY;
    if (face.axis == 2 && z == (face.up ? 7 : 0)) bits[z] = ~std::uint64_t{0};
  }
  return bits;
}

/// A set of tiles, numbered so that data of few tiles takes memory for those alone. Takes one and a half bits for each
/// tile that could be in the set.
class TileSet {
 public:
  explicit TileSet(std::size_t tiles) : bits_(tiles / 64 + 1), before_(bits_.size()) {}

  /// May be called by any thread, before number_them().
  void add(std::size_t tile) {
    std::atomic_ref<std::uint64_t> word(bits_[tile / 64]);
    const std::uint64_t bit = std::uint64_t{1} << tile % 64;
    if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
  }
  /// Numbers the tiles of the set, in the order of their indices.
  void number_them() {
    for (std::size_t n = 0; n < bits_.size(); ++n) {
      before_[n] = static_cast<std::uint32_t>(count_);
      count_ += static_cast<std::size_t>(std::popcount(bits_[n]));
    }
  }

  std::size_t count() const { return count_; }
  bool has(std::size_t tile) const { return (bits_[tile / 64] >> tile % 64 & 1) != 0; }
  /// The number of a tile of the set, from 0.
  std::size_t number(std::size_t tile) const {
    const std::uint64_t below = (std::uint64_t{1} << tile % 64) - 1;
    return before_[tile / 64] + static_cast<std::size_t>(std::popcount(bits_[tile / 64] & below));
  }
  /// Calls use(tile) for each, in order.
  template <class Use>
  void for_each(const Use& use) const {
    for (std::size_t n = 0; n < bits_.size(); ++n)
      for (std::uint64_t rest = bits_[n]; rest != 0; rest &= rest - 1)
        use(64 * n + static_cast<std::size_t>(std::countr_zero(rest)));
  }

 private:
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint32_t> before_;  // the number of tiles of the set before each word
  std::size_t count_ = 0;
};

}  // namespace standoff
