// SPDX-License-Identifier: Apache-2.0
// One bit for each sample of a grid.
#pragma once

#include <cstdint>
#include <vector>

#include "sign/each_row_of_tiles.h"

namespace standoff {

/// Rows along x, y before z; each begins with a new byte, its first sample in the lowest bit.
struct SampleBits {
  Size3 size;
  std::vector<std::uint8_t> bytes;

  explicit SampleBits(const Size3& samples)
      : size(samples), bytes(static_cast<std::size_t>(row_bytes() * samples.y * samples.z)) {}

  std::int64_t row_bytes() const { return (size.x + 7) / 8; }
  bool operator()(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return (bytes[static_cast<std::size_t>((k * size.y + j) * row_bytes() + i / 8)] >> (i % 8) & 1) != 0;
  }
};

/// Which samples are inside. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
inline SampleBits bits_of(Sides& sides, bool invert, const Grid& grid, ProgressMeter& progress) {
  constexpr std::int64_t kSide = InsideRows::kSide;
  SampleBits bits(grid.size);
  for_each_row_of_tiles(sides, invert, grid, progress, [&](const InsideRows& rows, std::int64_t ty, std::int64_t tz) {
    for (int row = 0; row < InsideRows::kRows; ++row) {
      if (!rows.in_grid(row)) continue;
      const std::int64_t j = kSide * ty + row % kSide, k = kSide * tz + row / kSide;
      std::uint8_t* const to = bits.bytes.data() + (k * grid.size.y + j) * bits.row_bytes();
      for (std::int64_t tx = 0; tx < bits.row_bytes(); ++tx) to[tx] = rows.tile(tx)[static_cast<std::size_t>(row)];
    }
  });
  return bits;
}

}  // namespace standoff
