// The emulation as the platform: device memory is plain memory, poisoned when it is new so that nothing can depend on
// what was there.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include "cuda/emulation/words.h"
#include "difi/cuda.h"

namespace difi::emulated {

using cuda::DeviceMesh;
using cuda::DeviceOutput;
using cuda::Outcome;
using cuda::Stream;
using cuda::Task;

/// Reads what other threads change meanwhile.
template <class T>
T load_relaxed(T* at) {
  return std::atomic_ref<T>(*at).load(std::memory_order_relaxed);
}

/// Few: blocks without work cost time here.
inline constexpr unsigned kManyBlocks = 3;

template <class... Parameters, class... Arguments>
void launch(Stream, const char* label, void (*kernel)(Parameters...), std::int64_t blocks, unsigned threads,
            const Arguments&... arguments) {
  emulation::launch(label, static_cast<unsigned>(blocks), threads, [&] { kernel(arguments...); });
}

inline void fill_bytes(Stream, void* at, int value, std::int64_t bytes) {
  std::memset(at, value, static_cast<std::size_t>(bytes));
}
inline void copy_in(void* to, const void* from, std::int64_t bytes) {
  std::memcpy(to, from, static_cast<std::size_t>(bytes));
}
inline void copy_out(void* to, const void* from, std::int64_t bytes) {
  std::memcpy(to, from, static_cast<std::size_t>(bytes));
}

class Memory {
 public:
  Memory() = default;
  explicit Memory(std::int64_t bytes)
      : at_(::operator new (static_cast<std::size_t>(bytes), std::align_val_t{kAlignment})) {
    std::memset(at_.get(), 0xcd, static_cast<std::size_t>(bytes));
  }
  template <class T>
  T* as() const {
    return static_cast<T*>(at_.get());
  }

 private:
  static constexpr std::size_t kAlignment = 256;  // cudaMalloc's
  struct Release {
    void operator()(void* at) const { ::operator delete (at, std::align_val_t{kAlignment}); }
  };
  std::unique_ptr<void, Release> at_;
};

}  // namespace difi::emulated
