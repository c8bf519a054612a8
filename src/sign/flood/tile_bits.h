// SPDX-License-Identifier: Apache-2.0
// Sets of samples of a tile, one bit each, and which of their neighbours they reach.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "sign/inside_rows.h"

namespace standoff {

/// A word for each z; sample (x, y) of it is bit x + 8 y.
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

/// The neighbours of the samples, by edges within the tile that are not crossed. The samples are among them.
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

/// The six neighbours of a tile: along `axis`, upwards or downwards.
struct Face {
  std::size_t axis;
  bool up;
};
inline constexpr std::array<Face, 6> kFaces = {{{0, true}, {0, false}, {1, true}, {1, false}, {2, true}, {2, false}}};

/// The samples of the tile beyond a face that samples of this tile reach by an edge that is not crossed. `lower`: the
/// edges of the lower one of both tiles, which those between them belong to.
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

/// Marks these samples of tile tx as inside. Requires samples within the grid, and rows that were cleared.
inline void mark(InsideRows& rows, std::int64_t tx, const TileBits& inside) {
  const auto tile = rows.tile(tx);
  for (std::size_t row = 0; row < tile.size(); ++row)
    tile[row] = static_cast<std::uint8_t>(inside[row / 8] >> 8 * (row % 8));
}

/// The samples of a grid's tile that are within the grid, which has so many samples.
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

}  // namespace standoff
