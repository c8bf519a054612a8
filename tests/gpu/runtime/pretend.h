// SPDX-License-Identifier: Apache-2.0
// A GPU that is not there: the calls of the CUDA runtime end here (the linker turns them over, see
// tests/CMakeLists.txt). Memory is the machine's, kernels are counted and not run. For what standoff asks of CUDA, in
// which order and on which stream, and for what it does where a call fails.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace standoff::pretend {

struct Call {
  std::string name;
  cudaStream_t stream;  // null where the call names none
};

struct Gpu {
  std::vector<int> capabilities{90, 90, 61};  // of each GPU, times ten; the first that a process asks for stay
  cudaError_t no_gpu = cudaSuccess;           // what counting GPUs fails with
  int driver = 13000;
  std::int64_t memory = std::int64_t{1} << 32;

  long fails_at = -1;  // the number of the call that fails, and as what
  cudaError_t failure = cudaErrorIllegalAddress;

  cudaError_t last = cudaSuccess;  // as CUDA keeps it until somebody asks

  std::vector<Call> calls;
  std::map<void*, std::int64_t> allocated;
  int current = 0;
};

/// The GPU that all calls go to.
extern Gpu gpu;

}  // namespace standoff::pretend
