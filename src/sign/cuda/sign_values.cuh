// SPDX-License-Identifier: Apache-2.0
// The sign of values whose bits the host decided. Apart from sign.cuh, as each file that includes a kernel compiles it.
#pragma once

#include <cstdint>

#include "core/tile_count.h"
#include "gpu/platform.cuh"

namespace standoff::STANDOFF_PLATFORM {

inline constexpr unsigned kSignThreads = 256;

/// Zero stays zero: a sample on the surface has no side.
STANDOFF_DEVICE float negated(float value) { return value == 0 ? value : -value; }

/// Gives dense values the signs of bits: rows along x, each of which begins with a new byte. A thread per byte.
STANDOFF_KERNEL void sign_by_bits(const unsigned char* bits, std::int64_t row_bytes, std::int64_t rows,
                                  std::int64_t size_x, float* values) {
  for (std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; n < row_bytes * rows;
       n += std::int64_t{blockDim.x} * gridDim.x) {
    const std::int64_t begin = kTileSide * (n % row_bytes), left = size_x - begin;
    float* const at = values + n / row_bytes * size_x + begin;
    for (int x = 0; x < kTileSide && x < left; ++x) {
      const float magnitude = abs(at[x]);
      at[x] = (bits[n] >> x & 1) != 0 ? negated(magnitude) : magnitude;
    }
  }
}

}  // namespace standoff::STANDOFF_PLATFORM
