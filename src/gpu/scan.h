// SPDX-License-Identifier: Apache-2.0
// Running sums: by CUB under nvcc (scan.cu), the only library on the GPU, and by a loop in the emulation
// (scan_emulated.cpp). No sorting is needed: lists are made by counting, and their order changes no bit of a field.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "gpu/devices.h"
#include "standoff/error.h"

namespace standoff {

using Counter = unsigned long long;

namespace gpu {

/// The most numbers of a running sum. CUB before 2.7 (CUDA 12.6 and older) counts them in an int: of more numbers, it
/// would silently sum only the first few.
constexpr std::int64_t longest_running_sum(int cub_version) {
  return cub_version < 200700 ? std::numeric_limits<std::int32_t>::max() : std::numeric_limits<std::int64_t>::max();
}

/// Throws Error{limit} if `count` exceeds `longest`.
inline void expect_summable(std::int64_t count, std::int64_t longest) {
  if (count > longest)
    throw Error(ErrorCode::limit,
                "cuda: a running sum over " + std::to_string(count) + " numbers, of which this build sums up " +
                    std::to_string(longest) +
                    " at most; make the work smaller, build standoff with CUDA 12.8 or newer, or use the CPU");
}

}  // namespace gpu

namespace cuda {
/// Bytes of scratch memory for a running sum over `count` numbers. Throws Error{limit} if the library sums fewer.
std::int64_t running_sum_bytes(std::int64_t count);
/// sums[n] = in[0] + ... + in[n - 1], for n in [0, count).
void running_sum(Stream stream, void* scratch, std::int64_t scratch_bytes, const std::uint32_t* in, Counter* sums,
                 std::int64_t count);
}  // namespace cuda

namespace emulated {
std::int64_t running_sum_bytes(std::int64_t count);
void running_sum(cuda::Stream stream, void* scratch, std::int64_t scratch_bytes, const std::uint32_t* in, Counter* sums,
                 std::int64_t count);
}  // namespace emulated

}  // namespace standoff
