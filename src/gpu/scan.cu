// SPDX-License-Identifier: Apache-2.0
#include "gpu/scan.h"

#include <cub/device/device_scan.cuh>
#include <cub/version.cuh>
#include <cuda/std/functional>

#include "gpu/platform.cuh"

namespace standoff::cuda {
namespace {

// The initial value is a 64-bit zero, which makes all sums 64-bit.
void run(void* scratch, std::size_t& bytes, const std::uint32_t* in, Counter* sums, std::int64_t count, Stream stream) {
  check_call(
      cub::DeviceScan::ExclusiveScan(scratch, bytes, in, sums, ::cuda::std::plus<Counter>{}, Counter{0}, count, stream),
      "cub::DeviceScan::ExclusiveScan");
}

}  // namespace

std::int64_t running_sum_bytes(std::int64_t count) {
  gpu::expect_summable(count, gpu::longest_running_sum(CUB_VERSION));
  std::size_t bytes = 0;
  run(nullptr, bytes, nullptr, nullptr, count, nullptr);
  return static_cast<std::int64_t>(bytes);
}

void running_sum(Stream stream, void* scratch, std::int64_t scratch_bytes, const std::uint32_t* in, Counter* sums,
                 std::int64_t count) {
  const Label named("running sum");
  auto bytes = static_cast<std::size_t>(scratch_bytes);
  run(scratch, bytes, in, sums, count, stream);
}

}  // namespace standoff::cuda
