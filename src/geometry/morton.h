// SPDX-License-Identifier: Apache-2.0
// Morton numbers of cells: the bits of three coordinates, interleaved. Near numbers are near places.
#pragma once

#include <cstdint>

namespace standoff {

namespace detail {

// Bits 0, 3, 6, ... of the result are those of v, which is below 2^21.
constexpr std::uint64_t spread(std::uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffff;
  v = (v | v << 16) & 0x001f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

}  // namespace detail

/// The number of cell (x, y, z): below 2^(3n) where each coordinate is below 2^n. Requires n of at most 21.
constexpr std::uint64_t morton(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return detail::spread(x) | detail::spread(y) << 1 | detail::spread(z) << 2;
}

}  // namespace standoff
