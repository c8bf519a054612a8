// Large arrays, on huge pages where the system has them: getting four thousand small pages costs more than filling them
// with a band (a sparse field of 40 MB costs a fifth less processor time), and finding them again, for queries at
// random places, more than the queries (a yes or no of two bodies takes 1.4 times as long without).
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace difi {

inline constexpr std::size_t kHugePage = std::size_t{2} << 20;

namespace big_memory {

inline constexpr std::size_t kLine = 64;
constexpr std::align_val_t alignment(std::size_t bytes) {
  return std::align_val_t{bytes >= kHugePage ? kHugePage : kLine};
}

inline void* allocate(std::size_t count, std::size_t size) {
  if (count > static_cast<std::size_t>(-1) / 2 / size) throw std::bad_array_new_length();
  const std::size_t bytes = count * size;
  void* const memory = ::operator new(bytes, alignment(bytes));
#ifdef __linux__
  // Whole pages only; a system that has none to give says no, which does no harm.
  if (bytes >= kHugePage) static_cast<void>(::madvise(memory, bytes & ~(kHugePage - 1), MADV_HUGEPAGE));
#endif
  return memory;
}
inline void free(void* memory, std::size_t bytes) { ::operator delete(memory, alignment(bytes)); }

}  // namespace big_memory

template <class T>
struct BigAllocator {
  using value_type = T;
  BigAllocator() = default;
  template <class U>
  BigAllocator(const BigAllocator<U>&) {}

  T* allocate(std::size_t count) { return static_cast<T*>(big_memory::allocate(count, sizeof(T))); }
  void deallocate(T* memory, std::size_t count) { big_memory::free(memory, count * sizeof(T)); }
  friend bool operator==(const BigAllocator&, const BigAllocator&) { return true; }
};

template <class T>
using BigVector = std::vector<T, BigAllocator<T>>;

/// Frees what big_array gave.
struct BigDelete {
  std::size_t bytes = 0;
  void operator()(void* memory) const { big_memory::free(memory, bytes); }
};
template <class T>
using BigArray = std::unique_ptr<T[], BigDelete>;

/// An array of numbers with undefined content.
template <class T>
BigArray<T> big_array(std::size_t count) {
  static_assert(std::is_trivial_v<T>);
  return {static_cast<T*>(big_memory::allocate(count, sizeof(T))), BigDelete{count * sizeof(T)}};
}

}  // namespace difi
