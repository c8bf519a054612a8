// SPDX-License-Identifier: Apache-2.0
// Memory that grows without moving: addresses are reserved once, pages are taken from the system step by step.
#pragma once

#include <cstddef>
#include <cstdint>

namespace standoff {

/// Called before pages are taken (bytes > 0; throws std::bad_alloc to refuse them) and after they are given back
/// (bytes < 0). Tests replace it as they replace operator new, to count memory and to refuse it.
inline void (*account_pages)(std::int64_t bytes) = [](std::int64_t) {};

/// Not safe from many threads at once, but what lies below size() may be used while another thread calls resize() with
/// a larger size.
class GrowingMemory {
 public:
  GrowingMemory() = default;
  GrowingMemory(const GrowingMemory&) = delete;
  GrowingMemory& operator=(const GrowingMemory&) = delete;
  ~GrowingMemory() { release(); }

  /// Reserves addresses for at least `bytes`, so that resize() need not move anything. Keeps the pages where the room
  /// is large enough already, and gives them back where it is not. Where the process may not use so many addresses
  /// (RLIMIT_AS), room() is smaller. Throws std::bad_alloc when there are hardly any.
  void reserve(std::size_t bytes);
  /// Where the system has huge pages, those beyond the first kHugePage are such, if resize() takes whole ones: a tenth
  /// of the time for 32 MiB.
  static constexpr std::size_t kHugePage = std::size_t{2} << 20;
  /// Takes or gives back pages, so that the first `bytes` can be used. New ones hold zeros. Requires bytes <= room().
  /// Throws std::bad_alloc where the system has no memory; nothing has changed then.
  void resize(std::size_t bytes);
  /// Gives everything back.
  void release() noexcept;

  void* data() const { return data_; }
  /// How far resize() may go.
  std::size_t room() const { return room_; }
  std::size_t size() const { return size_; }

 private:
  void* addresses_ = nullptr;  // all that are reserved: kHugePage more than the room
  void* data_ = nullptr;       // a multiple of kHugePage
  std::size_t room_ = 0, size_ = 0;
};

}  // namespace standoff
