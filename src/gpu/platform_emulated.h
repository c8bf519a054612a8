// SPDX-License-Identifier: Apache-2.0
// The emulation as the platform: device memory is plain memory, and new memory is poisoned, so that no result can
// depend on its content.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include "gpu/devices.h"
#include "gpu/emulation/words.h"
#include "standoff/testing/emulation.h"

namespace standoff::emulated {

using cuda::Stream;

inline constexpr Backend kBackend = testing::kEmulated;
inline constexpr bool kIsEmulated = true;

/// Reads a number that other threads may be changing.
template <class T>
T load_relaxed(T* at) {
  return std::atomic_ref<T>(*at).load(std::memory_order_relaxed);
}

/// Few blocks: blocks without work cost time here.
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

/// Does nothing: all work is done when launch() returns.
inline void wait_for(Stream) {}

/// The filling of new memory.
inline constexpr unsigned char kPoison = 0xcd;
/// For tests: counts words that were copied to the host without having been written, recognised by their poison. On a
/// GPU, initcheck of NVIDIA's sanitizer reports them.
inline std::atomic<std::int64_t> unwritten_words_copied{0};

inline void copy_out(void* to, const void* from, std::int64_t bytes) {
  std::memcpy(to, from, static_cast<std::size_t>(bytes));
  std::uint32_t word = 0, poison = 0;
  std::memset(&poison, kPoison, sizeof poison);
  std::int64_t unwritten = 0;
  for (std::int64_t at = 0; at + 4 <= bytes; at += 4) {
    std::memcpy(&word, static_cast<const char*>(to) + at, sizeof word);
    unwritten += word == poison;
  }
  unwritten_words_copied += unwritten;
}

inline void copy_in_later(void* to, const void* from, std::int64_t bytes, Stream) { copy_in(to, from, bytes); }
inline void copy_out_later(void* to, const void* from, std::int64_t bytes, Stream) { copy_out(to, from, bytes); }
/// Does nothing, as wait_for().
inline void finish_copies() noexcept {}

inline int current_device() { return 0; }

/// The emulated GPU's memory: bytes taken, and bytes in all, which tests may change.
inline std::atomic<std::int64_t> memory_taken{0};
inline std::atomic<std::int64_t> memory_total{std::int64_t{1} << 40};

/// Throws Error{limit} unless this number of bytes is free now.
inline void require_free_memory(std::int64_t bytes) {
  const std::int64_t free = memory_total - memory_taken;
  if (bytes > free) gpu::throw_out_of_memory(bytes, free, memory_total);
}

class Memory {
 public:
  Memory() = default;
  explicit Memory(std::int64_t bytes) {
    require_free_memory(bytes);
    at_ = {::operator new (static_cast<std::size_t>(bytes), std::align_val_t{kAlignment}), Release{bytes}};
    memory_taken += bytes;
    std::memset(at_.get(), kPoison, static_cast<std::size_t>(bytes));
  }
  template <class T>
  T* as() const {
    return static_cast<T*>(at_.get());
  }

 private:
  static constexpr std::size_t kAlignment = 256;  // cudaMalloc's
  struct Release {
    std::int64_t bytes;
    void operator()(void* at) const {
      ::operator delete (at, std::align_val_t{kAlignment});
      memory_taken -= bytes;
    }
  };
  std::unique_ptr<void, Release> at_;
};

class PinnedMemory {
 public:
  explicit PinnedMemory(std::int64_t bytes) : at_(new char[static_cast<std::size_t>(bytes)]) {}
  void* at() const { return at_.get(); }

 private:
  std::unique_ptr<char[]> at_;
};

/// Does nothing: copies are done when they return.
struct Event {
  void record(Stream) {}
  void wait() const {}
};

/// Does nothing: there is only one device.
struct DeviceScope {
  explicit DeviceScope(int) {}
};

}  // namespace standoff::emulated
