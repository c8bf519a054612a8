// SPDX-License-Identifier: Apache-2.0
// A heap that counts what is held, has a limit, and can refuse one allocation. It replaces operator new, and sees the
// pages of fields: include it in one file of a program.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>

#include "core/memory.h"

namespace standoff::testing::heap {

inline constexpr std::int64_t kUnlimited = std::numeric_limits<std::int64_t>::max();
inline std::atomic<std::int64_t> held{0}, most{0}, limit{kUnlimited};
/// How many more allocations succeed; the one after them fails, and those behind it succeed again.
inline std::atomic<std::int64_t> until_refusal{kUnlimited};

// Throws std::bad_alloc where so many bytes more are refused.
inline void count(std::int64_t bytes) {
  const std::int64_t now = held.fetch_add(bytes) + bytes;
  if (now > limit || until_refusal.fetch_sub(1) == 0) {
    held -= bytes;
    throw std::bad_alloc();
  }
  for (std::int64_t before = most; before < now && !most.compare_exchange_weak(before, now);) {
  }
}
inline const bool pages_are_counted = [] {
  account_pages = [](std::int64_t bytes) { bytes > 0 ? count(bytes) : static_cast<void>(held += bytes); };
  return true;
}();

// Every block begins with its length, in as many bytes as its alignment.
inline void* take(std::size_t bytes, std::size_t alignment) {
  if (bytes >= std::size_t{1} << 62) throw std::bad_alloc();
  count(static_cast<std::int64_t>(bytes));
  void* block = std::aligned_alloc(alignment, (bytes / alignment + 2) * alignment);
  if (!block) {
    held -= static_cast<std::int64_t>(bytes);
    throw std::bad_alloc();
  }
  *static_cast<std::size_t*>(block) = bytes;
  return static_cast<char*>(block) + alignment;
}
inline void give(void* block, std::size_t alignment) noexcept {
  if (!block) return;
  char* begin = static_cast<char*>(block) - alignment;
  held -= static_cast<std::int64_t>(*reinterpret_cast<std::size_t*>(begin));
  std::free(begin);
}
inline constexpr std::size_t kUsual = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

/// The most bytes on the heap while `call` runs, those before not counted.
template <class Call>
std::int64_t most_held(Call call) {
  const std::int64_t before = held;
  most = before;
  call();
  return most - before;
}

/// While it lives, no more than so many bytes can be taken.
class Limit {
 public:
  explicit Limit(std::int64_t bytes) { limit = held + bytes; }
  ~Limit() { limit = kUnlimited; }
};

/// While it lives, the allocation after so many others is refused.
class Refusal {
 public:
  explicit Refusal(std::int64_t after) { until_refusal = after; }
  ~Refusal() { until_refusal = kUnlimited; }
  /// Whether it has come to that.
  static bool happened() { return until_refusal < 0; }
};

}  // namespace standoff::testing::heap

// NOLINTBEGIN(misc-definitions-in-headers): see above
void* operator new(std::size_t bytes) { return standoff::testing::heap::take(bytes, standoff::testing::heap::kUsual); }
void* operator new[](std::size_t bytes) {
  return standoff::testing::heap::take(bytes, standoff::testing::heap::kUsual);
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return standoff::testing::heap::take(bytes, std::size_t(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
  return standoff::testing::heap::take(bytes, std::size_t(alignment));
}
void operator delete(void* block) noexcept { standoff::testing::heap::give(block, standoff::testing::heap::kUsual); }
void operator delete[](void* block) noexcept { standoff::testing::heap::give(block, standoff::testing::heap::kUsual); }
void operator delete(void* block, std::size_t) noexcept {
  standoff::testing::heap::give(block, standoff::testing::heap::kUsual);
}
void operator delete[](void* block, std::size_t) noexcept {
  standoff::testing::heap::give(block, standoff::testing::heap::kUsual);
}
void operator delete(void* block, std::align_val_t alignment) noexcept {
  standoff::testing::heap::give(block, std::size_t(alignment));
}
void operator delete[](void* block, std::align_val_t alignment) noexcept {
  standoff::testing::heap::give(block, std::size_t(alignment));
}
void operator delete(void* block, std::size_t, std::align_val_t alignment) noexcept {
  standoff::testing::heap::give(block, std::size_t(alignment));
}
void operator delete[](void* block, std::size_t, std::align_val_t alignment) noexcept {
  standoff::testing::heap::give(block, std::size_t(alignment));
}
// NOLINTEND(misc-definitions-in-headers)
