// SPDX-License-Identifier: Apache-2.0
// GPUs as code sees them that does not see CUDA's headers: which there are, and why there is none, of this build
// (devices.cu, or without_cuda.cpp) and of this machine; streams, memory, and copies of things in it.
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
/// Why it is not, in a sentence with what to do.
std::string why_not_available();
std::string device_name(int device);
/// Throws Error{device} that says why a GPU cannot be used: it is not there, or older than the kernels.
void check_usable(int device);

/// A cudaStream_t, as in standoff/cuda.h, which has it for its callers.
using Stream = CUstream_st*;

}  // namespace standoff::cuda

namespace standoff::gpu {

/// The work does not fit into the GPU's memory. A feature that knows how its work gets smaller catches it and says so.
class OutOfMemory : public Error {
 public:
  using Error::Error;
};

/// Throws OutOfMemory, an Error{limit}: `need` bytes were wanted, `free` of `total` were there. More may be wanted
/// later, when the work is better known.
[[noreturn]] inline void throw_out_of_memory(std::int64_t need, std::int64_t free, std::int64_t total) {
  const auto mib = [](std::int64_t bytes) { return std::to_string((bytes + (1 << 20) - 1) >> 20); };
  throw OutOfMemory(ErrorCode::limit,
                    "cuda: the work needs at least " + mib(need) + " MiB more of the GPU's memory, " +
                        std::to_string(free >> 20) + " of " + mib(total) + " MiB are free; use the CPU",
                    {.bytes_needed = need, .bytes_limit = free});
}

// One piece of memory cut into arrays, or, without memory, how much they take.

class Workspace {
 public:
  /// Of every array.
  static constexpr std::int64_t kAlignment = 256;

  /// Over `memory`, or over nothing to find out how much is needed.
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

// Copies of something in the memory of devices, made on first use and freed with it.

/// What lies in a device's memory; the backend derives from it.
class DeviceCopy {
 public:
  DeviceCopy() = default;
  virtual ~DeviceCopy() = default;
  DeviceCopy(const DeviceCopy&) = delete;
  DeviceCopy& operator=(const DeviceCopy&) = delete;
};

/// The copies of one thing. Safe to use from many threads.
class DeviceCopies {
 public:
  /// The copy for a device, from make() where there is none yet.
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
