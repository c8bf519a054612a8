// SPDX-License-Identifier: Apache-2.0
// What all lanes of a warp find out together. All 32 lanes take part in each of these.
#pragma once

#include <cstdint>

#include "gpu/platform.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// The bitwise or of all lanes' numbers.
STANDOFF_DEVICE std::uint32_t warp_or(std::uint32_t bits) {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 800
  return __reduce_or_sync(0xffffffffu, bits);
#else
  for (int step = 16; step > 0; step /= 2) bits |= __shfl_xor_sync(0xffffffffu, bits, step);
  return bits;
#endif
}

/// The least of all lanes' numbers.
STANDOFF_DEVICE std::uint32_t warp_min(std::uint32_t number) {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 800
  return __reduce_min_sync(0xffffffffu, number);
#else
  for (int step = 16; step > 0; step /= 2) {
    const std::uint32_t other = __shfl_xor_sync(0xffffffffu, number, step);
    number = other < number ? other : number;
  }
  return number;
#endif
}

/// The largest of all lanes' numbers.
STANDOFF_DEVICE float warp_max(float number) {
  for (int step = 16; step > 0; step /= 2) number = max(number, __shfl_xor_sync(0xffffffffu, number, step));
  return number;
}

/// The sum of all lanes' numbers.
template <class Number>
STANDOFF_DEVICE Number warp_sum(Number number) {
  for (int step = 16; step > 0; step /= 2) number += __shfl_xor_sync(0xffffffffu, number, step);
  return number;
}

/// The sum of the numbers of this lane and of all lanes before it.
template <class Number>
STANDOFF_DEVICE Number warp_sum_up_to(Number number) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  for (int step = 1; step < 32; step *= 2) {
    const Number before = __shfl_sync(0xffffffffu, number, lane - step);
    if (lane >= step) number += before;
  }
  return number;
}

/// The last of `count` ascending numbers that is at most `key`: its index, or 0. The lanes look at 32 numbers at once,
/// so a million takes four steps. If the numbers do not ascend, the index is one of theirs all the same.
template <class Number>
STANDOFF_DEVICE std::int64_t warp_find(const Number* ascending, std::int64_t count, Number key) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  std::int64_t low = 0, high = count;  // the index is from `low` to below `high`
  while (high - low > 1) {
    const std::int64_t apart = (high - low + 31) / 32, at = low + lane * apart;
    const std::uint32_t below = __ballot_sync(0xffffffffu, at < high && ascending[at] <= key);
    low += (__popc(below | 1) - 1) * apart;
    high = low + apart < high ? low + apart : high;
  }
  return low;
}

}  // namespace standoff::STANDOFF_PLATFORM
