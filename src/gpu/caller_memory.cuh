// SPDX-License-Identifier: Apache-2.0
// Device memory that a caller's allocator gives, or CUDA itself.
#pragma once

#include <cstdint>
#include <string>

#include "gpu/devices.h"
#include "gpu/platform.cuh"
#include "standoff/cuda_compute.h"

namespace standoff::STANDOFF_PLATFORM {

/// Memory that is replaced if it is too small; then its content is lost. No work on it may be left when it is replaced
/// or freed.
class CallerMemory {
 public:
  explicit CallerMemory(const cuda::Allocator& from) : from_(from) {}
  ~CallerMemory() { give_back(); }
  CallerMemory(const CallerMemory&) = delete;
  CallerMemory& operator=(const CallerMemory&) = delete;

  /// Returns room for `count` elements. Throws gpu::OutOfMemory, and Error{usage} if the allocator's memory is not
  /// aligned.
  template <class T>
  T* room_for(std::int64_t count) {
    if (!from_.allocate) return own_.room_for<T>(count);
    const std::int64_t bytes = count * static_cast<std::int64_t>(sizeof(T));
    if (bytes > bytes_) {
      give_back();
      take(bytes);
    }
    return static_cast<T*>(given_);
  }
  /// How much there is; as much or more than was asked for.
  std::int64_t bytes() const { return from_.allocate ? bytes_ : own_.bytes(); }

 private:
  void take(std::int64_t bytes) {
    given_ = from_.allocate(bytes);
    if (!given_)
      throw gpu::OutOfMemory(ErrorCode::limit,
                             "cuda: the caller's allocator has no " + std::to_string((bytes + (1 << 20) - 1) >> 20) +
                                 " MiB of the GPU's memory; free some, or use the CPU",
                             {.bytes_needed = bytes});
    if (reinterpret_cast<std::uintptr_t>(given_) % gpu::Workspace::kAlignment != 0) {
      give_back();
      throw Error(ErrorCode::usage, "cuda: the allocator's memory is not aligned to " +
                                        std::to_string(gpu::Workspace::kAlignment) +
                                        " bytes; give aligned memory, as cudaMalloc does");
    }
    bytes_ = bytes;
  }
  void give_back() {
    if (given_) from_.release(given_);
    given_ = nullptr;
    bytes_ = 0;
  }

  cuda::Allocator from_;
  Growing own_;
  void* given_ = nullptr;
  std::int64_t bytes_ = 0;
};

}  // namespace standoff::STANDOFF_PLATFORM
