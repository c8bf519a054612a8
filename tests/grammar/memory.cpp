// SPDX-License-Identifier: Apache-2.0
// The functions of malloc's family, in front of those of the C library: the linker gives ours to every library of the
// program. Blocks count by what the library set aside for them.
#include "tests/grammar/memory.h"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <limits>

namespace standoff::grammar {
namespace {

constexpr std::ptrdiff_t kNoLimit = std::numeric_limits<std::ptrdiff_t>::max();
std::atomic<std::ptrdiff_t> held{0}, peak{0}, limit{kNoLimit};
std::ptrdiff_t began = 0;
void (*past_limit)() = nullptr;

}  // namespace

void watch_memory(std::size_t most, void (*past)()) {
  past_limit = past;
  began = held;
  peak = began;
  limit = began + static_cast<std::ptrdiff_t>(most);
}

std::size_t peak_memory() {
  limit = kNoLimit;
  return static_cast<std::size_t>(peak - began);
}

}  // namespace standoff::grammar

#ifndef STANDOFF_SANITIZED

extern "C" {

void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

namespace {

using namespace standoff::grammar;

// Before it is asked for, so that a size no machine has is found too.
void ask_for(std::size_t bytes) {
  const std::ptrdiff_t most = limit;
  if (most == kNoLimit) return;
  if (bytes > static_cast<std::size_t>(most) || held + static_cast<std::ptrdiff_t>(bytes) > most) {
    limit = kNoLimit;
    past_limit();
  }
}

void* take(void* block) {
  const auto bytes = static_cast<std::ptrdiff_t>(malloc_usable_size(block));
  const std::ptrdiff_t now = held += bytes;
  for (std::ptrdiff_t before = peak; before < now && !peak.compare_exchange_weak(before, now);) {
  }
  return block;
}

void give(void* block) { held -= static_cast<std::ptrdiff_t>(malloc_usable_size(block)); }

}  // namespace

void* malloc(std::size_t bytes) {
  ask_for(bytes);
  return take(__libc_malloc(bytes));
}
void* calloc(std::size_t count, std::size_t bytes) {
  std::size_t all = 0;
  ask_for(__builtin_mul_overflow(count, bytes, &all) ? SIZE_MAX : all);
  return take(__libc_calloc(count, bytes));
}
void* realloc(void* block, std::size_t bytes) {
  ask_for(bytes);  // the old block lives until the new one is filled
  give(block);
  void* moved = __libc_realloc(block, bytes);
  return take(moved ? moved : bytes > 0 ? block : nullptr), moved;
}
void* memalign(std::size_t alignment, std::size_t bytes) {
  ask_for(bytes);
  return take(__libc_memalign(alignment, bytes));
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) { return memalign(alignment, bytes); }
int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) {
  *block = memalign(alignment, bytes);
  return *block ? 0 : ENOMEM;
}
void free(void* block) {
  give(block);
  __libc_free(block);
}

}  // extern "C"

#endif  // STANDOFF_SANITIZED
