// SPDX-License-Identifier: Apache-2.0
#include "core/growing_memory.h"

#include <sys/mman.h>
#include <sys/resource.h>

#include <bit>
#include <memory>
#include <new>

namespace standoff {
namespace {

// Addresses alone: they cost no memory, nor do they count against what the system promises to its processes.
void* reserved_addresses(std::size_t room) {
  void* const at =
      ::mmap(nullptr, room + GrowingMemory::kHugePage, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return at == MAP_FAILED ? nullptr : at;
}

bool addresses_are_limited() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

}  // namespace

void GrowingMemory::reserve(std::size_t bytes) {
  if (bytes <= room_) return;
  release();
  constexpr std::size_t kLeast = std::size_t{1} << 20;
  // A power of two, so that a little more the next time needs no new room; but no more than asked for where addresses
  // are counted.
  std::size_t room = addresses_are_limited() ? bytes : std::bit_ceil(bytes);
  void* at = reserved_addresses(room);
  while (!at && room / 2 >= kLeast) {
    room /= 2;
    at = reserved_addresses(room);
    if (!at) continue;
    // All that is left would leave none for others: take half of it.
    ::munmap(at, room + kHugePage);
    room = room / 2 / kLeast * kLeast;
    at = room > 0 ? reserved_addresses(room) : nullptr;
    break;
  }
  if (!at) throw std::bad_alloc();
  addresses_ = at;
  room_ = room;
  data_ = at;
  std::size_t space = room + kHugePage;
  std::align(kHugePage, room, data_, space);
#ifdef MADV_HUGEPAGE
  // A system without them says no, which does no harm.
  if (room > kHugePage)
    static_cast<void>(::madvise(static_cast<char*>(data_) + kHugePage, room - kHugePage, MADV_HUGEPAGE));
#endif
}

void GrowingMemory::resize(std::size_t bytes) {
  char* const begin = static_cast<char*>(data_);
  const std::int64_t change = static_cast<std::int64_t>(bytes) - static_cast<std::int64_t>(size_);
  if (change > 0) {
    account_pages(change);
    if (::mprotect(begin + size_, bytes - size_, PROT_READ | PROT_WRITE) != 0) {
      account_pages(-change);
      throw std::bad_alloc();
    }
  } else if (change < 0) {
    // New addresses in place of the old ones: that gives the pages back, and their promise.
    if (::mmap(begin + bytes, size_ - bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1,
               0) == MAP_FAILED)
      return;  // they stay
    account_pages(change);
  }
  size_ = bytes;
}

void GrowingMemory::release() noexcept {
  if (!data_) return;
  ::munmap(addresses_, room_ + kHugePage);
  if (size_ > 0) account_pages(-static_cast<std::int64_t>(size_));
  addresses_ = data_ = nullptr;
  room_ = size_ = 0;
}

}  // namespace standoff
