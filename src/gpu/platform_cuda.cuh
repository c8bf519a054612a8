// SPDX-License-Identifier: Apache-2.0
// CUDA as the platform: launches with labels, memory, errors that name call, file and line.
#pragma once

#include <cuda_runtime.h>

#if __has_include(<nvtx3/nvToolsExt.h>)  // comes with the whole toolkit, not with nvcc alone
#include <nvtx3/nvToolsExt.h>
#define STANDOFF_HAVE_NVTX 1
#endif
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "gpu/devices.h"
#include "standoff/error.h"
#include "standoff/execution.h"

namespace standoff::cuda {

inline constexpr Backend kBackend = Backend::cuda;
inline constexpr bool kIsEmulated = false;

/// A call site in standoff. As the default of a parameter, it is the site of the call without that parameter. (nvcc
/// before 12.2 does not accept std::source_location::current() as a constant there.)
struct CallSite {
  const char* file;
  int line;
  static constexpr CallSite current(const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    return {file, line};
  }
};

/// Throws Error{device} if a call of CUDA failed; the error names the call site in standoff. Clears CUDA's error, so
/// that later calls do not see it.
inline void check_call(cudaError_t result, const char* call, const CallSite& at = CallSite::current()) {
  if (result == cudaSuccess) return;
  cudaGetLastError();
  throw Error(ErrorCode::device, std::string("cuda: ") + call + " failed at " + at.file + ":" +
                                     std::to_string(at.line) + ": " + cudaGetErrorString(result) +
                                     "; see what devices() of standoff/cuda.h says, or use the CPU");
}

/// Labels the host's work for NVIDIA's profilers.
class Label {
 public:
#ifdef STANDOFF_HAVE_NVTX
  explicit Label(const char* text) { nvtxRangePushA(text); }
  ~Label() { nvtxRangePop(); }
#else
  explicit Label(const char*) {}
#endif
  Label(const Label&) = delete;
  Label& operator=(const Label&) = delete;
};

/// Reads a number that other threads may be changing.
template <class T>
__device__ __forceinline__ T load_relaxed(T* at) {
  return *const_cast<volatile T*>(at);
}

/// The number of blocks of kernels that stride over work of unknown size: enough to fill a GPU.
inline constexpr unsigned kManyBlocks = 2048;

/// The label and the call site of a launch.
struct LaunchName {
  const char* label;
  CallSite at;
  LaunchName(const char* text, const CallSite& site = CallSite::current()) : label(text), at(site) {}
};

template <class... Parameters, class... Arguments>
void launch(Stream stream, const LaunchName& name, void (*kernel)(Parameters...), std::int64_t blocks, unsigned threads,
            const Arguments&... arguments) {
  const Label named(name.label);
  cudaLaunchConfig_t shape{};
  shape.gridDim = dim3(static_cast<unsigned>(blocks));
  shape.blockDim = dim3(threads);
  shape.stream = stream;
  // Unlike <<<>>> it returns its own error, not one that the caller of standoff left unread.
  check_call(cudaLaunchKernelEx(&shape, kernel, Parameters(arguments)...), name.label, name.at);
}

inline void fill_bytes(Stream stream, void* to, int value, std::int64_t bytes,
                       const CallSite& at = CallSite::current()) {
  check_call(cudaMemsetAsync(to, value, static_cast<std::size_t>(bytes), stream), "cudaMemsetAsync", at);
}
inline void copy_in(void* to, const void* from, std::int64_t bytes, const CallSite& at = CallSite::current()) {
  check_call(cudaMemcpy(to, from, static_cast<std::size_t>(bytes), cudaMemcpyHostToDevice), "cudaMemcpy to the GPU",
             at);
}
inline void copy_out(void* to, const void* from, std::int64_t bytes, const CallSite& at = CallSite::current()) {
  check_call(cudaMemcpy(to, from, static_cast<std::size_t>(bytes), cudaMemcpyDeviceToHost), "cudaMemcpy from the GPU",
             at);
}

/// Copies on the stream. From or to memory that is not pinned it takes longer; the memory must last until it is done.
inline void copy_in_later(void* to, const void* from, std::int64_t bytes, Stream stream,
                          const CallSite& at = CallSite::current()) {
  check_call(cudaMemcpyAsync(to, from, static_cast<std::size_t>(bytes), cudaMemcpyHostToDevice, stream),
             "cudaMemcpyAsync to the GPU", at);
}
inline void copy_out_later(void* to, const void* from, std::int64_t bytes, Stream stream,
                           const CallSite& at = CallSite::current()) {
  check_call(cudaMemcpyAsync(to, from, static_cast<std::size_t>(bytes), cudaMemcpyDeviceToHost, stream),
             "cudaMemcpyAsync from the GPU", at);
}

/// Waits until all work on the stream is done.
inline void wait_for(Stream stream, const CallSite& at = CallSite::current()) {
  check_call(cudaStreamSynchronize(stream), "cudaStreamSynchronize", at);
}

/// Waits for the default stream, after a failure, where nothing more may be thrown.
inline void finish_copies() noexcept {
  if (cudaStreamSynchronize(nullptr) != cudaSuccess) cudaGetLastError();
}

inline int current_device(const CallSite& at = CallSite::current()) {
  int device = 0;
  check_call(cudaGetDevice(&device), "cudaGetDevice", at);
  return device;
}

/// Throws Error{limit} unless this number of bytes is free now.
inline void require_free_memory(std::int64_t bytes, const CallSite& at = CallSite::current()) {
  std::size_t free = 0, total = 0;
  check_call(cudaMemGetInfo(&free, &total), "cudaMemGetInfo", at);
  if (bytes > static_cast<std::int64_t>(free))
    gpu::throw_out_of_memory(bytes, static_cast<std::int64_t>(free), static_cast<std::int64_t>(total));
}

/// Device memory that frees itself.
class Memory {
 public:
  Memory() = default;
  explicit Memory(std::int64_t bytes, const CallSite& at = CallSite::current()) {
    const cudaError_t result = cudaMalloc(&at_, static_cast<std::size_t>(bytes > 0 ? bytes : 1));
    if (result == cudaErrorMemoryAllocation) {
      cudaGetLastError();
      std::size_t free = 0, total = 0;
      cudaMemGetInfo(&free, &total);
      gpu::throw_out_of_memory(bytes, static_cast<std::int64_t>(free), static_cast<std::int64_t>(total));
    }
    check_call(result, "cudaMalloc", at);
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

/// Host memory that the GPU reads and writes by itself. If the system pins no more, plain memory takes its place, from
/// and to which copies are slower.
class PinnedMemory {
 public:
  explicit PinnedMemory(std::int64_t bytes, const CallSite& at = CallSite::current()) {
    const cudaError_t result = cudaHostAlloc(&at_, static_cast<std::size_t>(bytes), cudaHostAllocPortable);
    if (result == cudaErrorMemoryAllocation) {
      cudaGetLastError();
      plain_ = std::make_unique<char[]>(static_cast<std::size_t>(bytes));
      at_ = plain_.get();
      return;
    }
    check_call(result, "cudaHostAlloc", at);
  }
  ~PinnedMemory() {
    if (!plain_ && cudaFreeHost(at_) != cudaSuccess) cudaGetLastError();
  }
  PinnedMemory(const PinnedMemory&) = delete;
  PinnedMemory& operator=(const PinnedMemory&) = delete;
  void* at() const { return at_; }

 private:
  void* at_ = nullptr;
  std::unique_ptr<char[]> plain_;
};

/// A point of a stream that the host can wait for. Until one is recorded, there is nothing to wait for.
class Event {
 public:
  explicit Event(const CallSite& at = CallSite::current()) {
    check_call(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming), "cudaEventCreateWithFlags", at);
  }
  ~Event() {
    if (cudaEventDestroy(event_) != cudaSuccess) cudaGetLastError();
  }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  void record(Stream stream, const CallSite& at = CallSite::current()) {
    check_call(cudaEventRecord(event_, stream), "cudaEventRecord", at);
  }
  void wait(const CallSite& at = CallSite::current()) const {
    check_call(cudaEventSynchronize(event_), "cudaEventSynchronize", at);
  }

 private:
  cudaEvent_t event_ = nullptr;
};

/// Makes a device the current one while it lives. It sets it only if it must, as this starts CUDA on the device.
class DeviceScope {
 public:
  explicit DeviceScope(int device, const CallSite& at = CallSite::current()) {
    check_usable(device);
    check_call(cudaGetDevice(&before_), "cudaGetDevice", at);
    if (device == before_) return;
    check_call(cudaSetDevice(device), "cudaSetDevice", at);
    changed_ = true;
  }
  ~DeviceScope() {
    if (changed_) cudaSetDevice(before_);
  }
  DeviceScope(const DeviceScope&) = delete;
  DeviceScope& operator=(const DeviceScope&) = delete;

 private:
  int before_ = 0;
  bool changed_ = false;
};

}  // namespace standoff::cuda
