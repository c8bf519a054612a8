// SPDX-License-Identifier: Apache-2.0
// One piece of memory cut into arrays, or, without memory, how much they take.
#pragma once

#include <cstdint>

namespace standoff::gpu {

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

}  // namespace standoff::gpu
