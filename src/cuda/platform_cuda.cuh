// CUDA as the platform: launches with a label, memory, errors that name call, file and line.
#pragma once

#include <cuda_runtime.h>

#include <nvtx3/nvToolsExt.h>
#include <cstdint>
#include <source_location>
#include <string>

#include "difi/cuda.h"
#include "difi/error.h"

namespace difi::cuda {

/// Throws Error{device} where a call of CUDA failed. The error is taken from CUDA, so that later calls do not see it.
inline void check_call(cudaError_t result, const char* call,
                       const std::source_location& at = std::source_location::current()) {
  if (result == cudaSuccess) return;
  cudaGetLastError();
  throw Error(ErrorCode::device, std::string("cuda: ") + call + " failed at " + at.file_name() + ":" +
                                     std::to_string(at.line()) + ": " + cudaGetErrorString(result) +
                                     "; run `difi devices`, or use the CPU (--device cpu)");
}

/// Names what the host does, for NVIDIA's profilers.
class Label {
 public:
  explicit Label(const char* text) { nvtxRangePushA(text); }
  ~Label() { nvtxRangePop(); }
  Label(const Label&) = delete;
  Label& operator=(const Label&) = delete;
};

/// Reads what other threads change meanwhile.
template <class T>
__device__ __forceinline__ T load_relaxed(T* at) {
  return *const_cast<volatile T*>(at);
}

/// Enough blocks to fill a GPU, for kernels that stride over work of unknown size.
inline constexpr unsigned kManyBlocks = 2048;

template <class... Parameters, class... Arguments>
void launch(Stream stream, const char* label, void (*kernel)(Parameters...), std::int64_t blocks, unsigned threads,
            const Arguments&... arguments) {
  const Label named(label);
  kernel<<<static_cast<unsigned>(blocks), threads, 0, stream>>>(arguments...);
  check_call(cudaPeekAtLastError(), label);
}

inline void fill_bytes(Stream stream, void* at, int value, std::int64_t bytes) {
  check_call(cudaMemsetAsync(at, value, static_cast<std::size_t>(bytes), stream), "cudaMemsetAsync");
}
inline void copy_in(void* to, const void* from, std::int64_t bytes) {
  check_call(cudaMemcpy(to, from, static_cast<std::size_t>(bytes), cudaMemcpyHostToDevice), "cudaMemcpy to the GPU");
}
inline void copy_out(void* to, const void* from, std::int64_t bytes) {
  check_call(cudaMemcpy(to, from, static_cast<std::size_t>(bytes), cudaMemcpyDeviceToHost), "cudaMemcpy from the GPU");
}

/// Device memory that frees itself.
class Memory {
 public:
  Memory() = default;
  explicit Memory(std::int64_t bytes) {
    const cudaError_t result = cudaMalloc(&at_, static_cast<std::size_t>(bytes > 0 ? bytes : 1));
    if (result == cudaErrorMemoryAllocation) {
      cudaGetLastError();
      std::size_t free = 0, total = 0;
      cudaMemGetInfo(&free, &total);
      throw Error(ErrorCode::limit, "cuda: the GPU has no room for " + std::to_string(bytes >> 20) + " MiB more; " +
                                        std::to_string(free >> 20) + " of " + std::to_string(total >> 20) +
                                        " MiB are free; take fewer samples or a smaller thickness, or use the CPU "
                                        "(--device cpu)");
    }
    check_call(result, "cudaMalloc");
  }
  ~Memory() { cudaFree(at_); }
  Memory(Memory&& other) noexcept : at_(other.at_) { other.at_ = nullptr; }
  Memory& operator=(Memory&& other) noexcept {
    std::swap(at_, other.at_);
    return *this;
  }
  template <class T>
  T* as() const {
    return static_cast<T*>(at_);
  }

 private:
  void* at_ = nullptr;
};

}  // namespace difi::cuda
