// The one thing taken from a library: running sums. CUB under nvcc (scan.cu), a loop in the emulation
// (scan_emulated.cpp). Nothing has to be sorted: lists come from counting, and their order changes no bit of a field.
#pragma once

#include <cstdint>

#include "difi/cuda.h"

namespace difi {

using Counter = unsigned long long;

namespace cuda {
/// Bytes of scratch that a running sum over `count` numbers wants.
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

}  // namespace difi
