// SPDX-License-Identifier: Apache-2.0
// Memory of large work: memory that grows without moving, the tiles of fields, limits that callers set, and huge pages.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <type_traits>
#include <vector>

#include "standoff/error.h"
#include "standoff/field.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace standoff {

/// Called before pages are taken (bytes > 0; it throws std::bad_alloc to refuse them) and after they are returned
/// (bytes < 0). Tests replace it, as they replace operator new, to count memory and to refuse it.
inline void (*account_pages)(std::int64_t bytes) = [](std::int64_t) {};

/// Memory that grows without moving: it reserves addresses once, and takes pages from the system step by step. It is
/// not thread-safe, but memory below size() may be used while another thread calls resize() with a larger size.
class GrowingMemory {
 public:
  GrowingMemory() = default;
  GrowingMemory(const GrowingMemory&) = delete;
  GrowingMemory& operator=(const GrowingMemory&) = delete;
  ~GrowingMemory() { release(); }

  /// Reserves addresses for at least `bytes`, so that resize() need not move anything. Keeps the pages if the room is
  /// large enough already, else returns them. If the process may not use that many addresses (RLIMIT_AS), room() is
  /// smaller. Throws std::bad_alloc if there are hardly any.
  void reserve(std::size_t bytes);
  /// If the system has huge pages, memory beyond the first kHugePage uses them, provided that resize() takes whole
  /// ones: this takes a tenth of the time for 32 MiB.
  static constexpr std::size_t kHugePage = std::size_t{2} << 20;
  /// Takes or returns pages, so that the first `bytes` can be used. New pages hold zeros. Requires bytes <= room().
  /// Throws std::bad_alloc if the system has no memory; nothing has changed then.
  void resize(std::size_t bytes);
  /// Returns all pages and addresses.
  void release() noexcept;

  void* data() const { return data_; }
  /// The largest size for resize().
  std::size_t room() const { return room_; }
  std::size_t size() const { return size_; }

 private:
  void* addresses_ = nullptr;  // the reserved addresses: kHugePage more than the room
  void* data_ = nullptr;       // a multiple of kHugePage
  std::size_t room_ = 0, size_ = 0;
};

/// The memory of a field's stored tiles: an array of values and an array of nearest triangles, with a slot for each
/// tile. Slots never move, so threads can fill tiles while others add some.
class TilePool {
 public:
  /// The number of tiles that memory is taken for if this number is stored. Small fields take 512 KiB of values at a
  /// time; past 2 MiB the steps are whole huge pages, which cost a tenth of small ones.
  static std::int64_t in_steps(std::int64_t tiles) {
    constexpr std::int64_t kHugePage = GrowingMemory::kHugePage / (sizeof(float) * DistanceField::kTileSamples);
    const std::int64_t step = tiles <= kHugePage ? kHugePage / 4 : kHugePage;
    return (tiles + step - 1) / step * step;
  }

  /// Removes all tiles. Keeps the memory for the next ones, as far as `max_tiles` can use it.
  void clear(std::int64_t max_tiles, bool with_nearest);
  /// Makes an empty pool a copy of the tiles of another.
  void copy_from(const TilePool& other);

  /// Adds a slot, whose values and nearest triangles are undefined. Thread-safe. Throws std::bad_alloc, or Error{limit}
  /// if the process may not use more addresses; the pool is unchanged then.
  std::int64_t add();
  /// Frees the memory of the nearest triangles.
  void release_nearest() {
    with_nearest_ = false;
    nearest_.release();
  }
  /// Removes the last slot.
  void remove_last() { --used_; }

  std::int64_t size() const { return used_; }
  float* values(std::int64_t slot) const {
    return static_cast<float*>(values_.data()) + slot * DistanceField::kTileSamples;
  }
  /// Requires clear(.., true).
  std::uint32_t* nearest(std::int64_t slot) const {
    return static_cast<std::uint32_t*>(nearest_.data()) + slot * DistanceField::kTileSamples;
  }

 private:
  void grow(std::int64_t tiles);

  GrowingMemory values_, nearest_;
  bool with_nearest_ = false;
  std::atomic<std::int64_t> used_{0};
  std::atomic<std::int64_t> room_{0};  // the number of tiles that there is memory for
  std::mutex growing_;
};

// The limits that callers set: an option of 0 stands for a share of the machine's memory.

/// The limit in bytes that an option of this value sets; 0 where it is none.
std::int64_t memory_limit_of(std::int64_t option);

// How much memory a field takes, and the error of a limit that is too small.

/// Bytes that a DistanceField takes with so many tiles stored, of so many in its grid.
double field_bytes(double stored_tiles, double all_tiles, bool with_nearest);

/// "161 MiB, more than the limit of 160 MiB". Requires needed > limit; the text shows the difference.
std::string over_the_limit(double needed, double limit);
/// The same as data.
ErrorDetails limit_details(double needed, double limit);

/// Counts the bytes that a call holds against its caller's limit. Thread-safe.
class MemoryBudget {
 public:
  /// `limit`: bytes; 0 for none. `where` begins the error's text, and `what_to_do` ends it.
  MemoryBudget(const char* where, std::int64_t limit, const char* what_to_do)
      : where_(where), what_to_do_(what_to_do), limit_(limit) {}

  /// Must be called before `bytes` are allocated. Throws Error{limit} if they are too many.
  void take(std::size_t bytes) {
    const std::int64_t needed =
        held_.fetch_add(static_cast<std::int64_t>(bytes), std::memory_order_relaxed) + static_cast<std::int64_t>(bytes);
    if (limit_ == 0 || needed <= limit_) return;
    const auto all = static_cast<double>(needed), limit = static_cast<double>(limit_);
    throw Error(ErrorCode::limit,
                std::string(where_) + ": the memory limit is too low: it needs " + over_the_limit(all, limit) + "; " +
                    what_to_do_,
                {.bytes_needed = needed, .bytes_limit = limit_});
  }
  void give_back(std::size_t bytes) noexcept {
    held_.fetch_sub(static_cast<std::int64_t>(bytes), std::memory_order_relaxed);
  }

 private:
  const char *where_, *what_to_do_;
  std::int64_t limit_;
  std::atomic<std::int64_t> held_{0};
};

/// The bytes that are held while this lives.
class MemoryShare {
 public:
  explicit MemoryShare(MemoryBudget& budget) : budget_(budget) {}
  MemoryShare(const MemoryShare&) = delete;
  MemoryShare& operator=(const MemoryShare&) = delete;
  ~MemoryShare() { budget_.give_back(bytes_); }

  void take(std::size_t bytes) {
    bytes_ += bytes;
    budget_.take(bytes);
  }
  MemoryBudget& budget() { return budget_; }

 private:
  MemoryBudget& budget_;
  std::size_t bytes_ = 0;
};

// Arrays that are read or written at random indices lie on huge pages if the system has them: otherwise much of the
// time goes into TLB misses (collide takes 1.4 times as long, points near a small mesh 1.15 times).

template <class T>
struct HugePageAllocator {
  using value_type = T;
  HugePageAllocator() = default;
  template <class U>
  HugePageAllocator(const HugePageAllocator<U>&) {}

  static constexpr std::size_t kHugePage = std::size_t{2} << 20;
  static constexpr std::size_t kLine = 64;

  T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_array_new_length();
    const std::size_t bytes = count * sizeof(T);
    void* const memory = ::operator new (bytes, std::align_val_t{alignment(bytes)});
#ifdef __linux__
    // Ask for whole pages only. A system without them refuses, which does no harm.
    if (bytes >= kHugePage) static_cast<void>(::madvise(memory, bytes & ~(kHugePage - 1), MADV_HUGEPAGE));
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) {
    ::operator delete (memory, std::align_val_t{alignment(count * sizeof(T))});
  }
  friend bool operator==(const HugePageAllocator&, const HugePageAllocator&) { return true; }

 private:
  static std::size_t alignment(std::size_t bytes) { return bytes >= kHugePage ? kHugePage : kLine; }
};

template <class T>
using HugePageVector = std::vector<T, HugePageAllocator<T>>;

/// An array that is not set at first: the zeros of a vector would be written by one thread.
template <class T>
class HugePageArray {
 public:
  HugePageArray() = default;
  explicit HugePageArray(std::size_t size) : memory_(HugePageAllocator<T>().allocate(size), Free{size}) {}

  std::size_t size() const { return memory_.get_deleter().size; }
  T* data() { return memory_.get(); }
  const T* data() const { return memory_.get(); }
  T& operator[](std::size_t n) { return memory_[n]; }
  const T& operator[](std::size_t n) const { return memory_[n]; }

 private:
  static_assert(std::is_trivially_destructible_v<T>);
  struct Free {
    std::size_t size = 0;
    void operator()(T* memory) const { HugePageAllocator<T>().deallocate(memory, size); }
  };
  std::unique_ptr<T[], Free> memory_;
};

/// Asks for huge pages for fresh memory, which nobody has written to: its first use is then several times faster. A
/// system without huge pages refuses, which does no harm.
inline void advise_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#ifdef __linux__
  constexpr std::uintptr_t kHugePage = std::uintptr_t{2} << 20;
  const auto begin = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t first = (begin + kHugePage - 1) & ~(kHugePage - 1), end = (begin + bytes) & ~(kHugePage - 1);
  if (first < end) static_cast<void>(::madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE));
#endif
}

}  // namespace standoff
