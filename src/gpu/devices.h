// SPDX-License-Identifier: Apache-2.0
// GPUs for code that does not include CUDA's headers: which GPUs this build (devices.cu, or without_cuda.cpp) and this
// machine have, and why there is none; streams, workspaces, and copies in device memory.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "standoff/error.h"
#include "standoff/execution.h"

struct CUstream_st;

namespace standoff::cuda {

bool available();
/// A sentence that says why CUDA is not available, and what to do.
std::string why_not_available();
std::string device_name(int device);
/// Throws Error{device} if a GPU cannot be used, because it does not exist or is older than the kernels.
void check_usable(int device);

/// A cudaStream_t, as in standoff/cuda.h.
using Stream = CUstream_st*;

}  // namespace standoff::cuda

namespace standoff::gpu {

/// The work does not fit into the GPU's memory. A feature that knows how to make its work smaller catches this and adds
/// that advice.
class OutOfMemory : public Error {
 public:
  using Error::Error;
};

/// Throws OutOfMemory, an Error{limit}: the work needs at least `need` bytes, but only `free` of `total` are free.
[[noreturn]] inline void throw_out_of_memory(std::int64_t need, std::int64_t free, std::int64_t total) {
  const auto mib = [](std::int64_t bytes) { return std::to_string((bytes + (1 << 20) - 1) >> 20); };
  throw OutOfMemory(ErrorCode::limit,
                    "cuda: the work needs at least " + mib(need) + " MiB more of the GPU's memory, " +
                        std::to_string(free >> 20) + " of " + mib(total) + " MiB are free; use the CPU",
                    {.bytes_needed = need, .bytes_limit = free});
}

// A piece of memory that is cut into arrays; without memory, it measures them.

class Workspace {
 public:
  /// The alignment of every array.
  static constexpr std::int64_t kAlignment = 256;

  /// Cuts `memory`; null only measures.
  explicit Workspace(void* memory) : memory_(static_cast<char*>(memory)) {}

  template <class T>
  T* take(std::int64_t count) {
    char* const at = memory_ ? memory_ + used_ : nullptr;
    const std::int64_t bytes = count * static_cast<std::int64_t>(sizeof(T));
    used_ += (bytes + kAlignment - 1) / kAlignment * kAlignment;
    return reinterpret_cast<T*>(at);
  }
  std::int64_t used() const { return used_; }

 private:
  char* memory_;
  std::int64_t used_ = 0;
};

// Copies of an object in the memory of devices are made on first use, and freed with the object.

/// A copy in a device's memory; the backend derives its own type from this.
class DeviceCopy {
 public:
  DeviceCopy() = default;
  virtual ~DeviceCopy() = default;
  DeviceCopy(const DeviceCopy&) = delete;
  DeviceCopy& operator=(const DeviceCopy&) = delete;
};

/// The copies of an object. Thread-safe.
class DeviceCopies {
 public:
  /// The copy for a device; make() makes it if there is none yet.
  template <class Make>
  std::shared_ptr<const DeviceCopy> get(Backend backend, int device, Make make) const {
    const std::lock_guard lock(mutex_);
    auto& copy = copies_[{backend, device}];
    if (!copy) copy = make();
    return copy;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::map<std::pair<Backend, int>, std::shared_ptr<const DeviceCopy>> copies_;
};

}  // namespace standoff::gpu
