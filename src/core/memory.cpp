// SPDX-License-Identifier: Apache-2.0
#include "core/memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <new>
#include <string>

#include "standoff/error.h"
#include "standoff/field.h"
#include "standoff/memory.h"

namespace standoff {
namespace {

// What a file of the system says, a number of bytes at its beginning; 0 where it says none. Takes no memory.
double number_in(const char* path) {
  const int file = ::open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  char text[64];
  const ssize_t length = ::read(file, text, sizeof text);
  ::close(file);
  double number = 0;
  if (length > 0) std::from_chars(text, text + length, number);
  return number;
}

std::int64_t share_of_machine() {
  constexpr double kShare = 0.8;
  double bytes = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGE_SIZE));
  // A container's limit, for control groups of version 2 and 1. No limit reads as "max" or as a huge number.
  for (const char* file : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"})
    if (const double limit = number_in(file); limit > 0) bytes = std::min(bytes, limit);
  return bytes > 0 ? static_cast<std::int64_t>(bytes * kShare) : kNoMemoryLimit;
}

}  // namespace

std::int64_t default_memory_limit() {
  static const std::int64_t limit = share_of_machine();
  return limit;
}

std::int64_t memory_limit_of(std::int64_t option) {
  return std::max<std::int64_t>(option == 0 ? default_memory_limit() : option, 0);
}

namespace {

// Reserves addresses: they cost no memory, and do not count against the system's limit of committed memory.
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
  // Take a power of two, so that slightly more needs no new room next time; but no more than asked for if addresses are
  // limited.
  std::size_t room = addresses_are_limited() ? bytes : std::bit_ceil(bytes);
  void* at = reserved_addresses(room);
  while (!at && room / 2 >= kLeast) {
    room /= 2;
    at = reserved_addresses(room);
    if (!at) continue;
    // Take half of the addresses that are left, so that some remain for others.
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
  // A system without huge pages refuses, which does no harm.
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
    // Map new addresses over the old ones: this returns the pages, and the commitment for them.
    if (::mmap(begin + bytes, size_ - bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1,
               0) == MAP_FAILED)
      return;  // the pages stay
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

namespace {

// Values and nearest triangles have the same size.
constexpr std::size_t kTileBytes = sizeof(float) * DistanceField::kTileSamples;
static_assert(sizeof(float) == sizeof(std::uint32_t));

std::size_t bytes_of(std::int64_t tiles) { return static_cast<std::size_t>(tiles) * kTileBytes; }
std::int64_t tiles_in(std::size_t bytes) { return static_cast<std::int64_t>(bytes / kTileBytes); }

}  // namespace

void TilePool::clear(std::int64_t max_tiles, bool with_nearest) {
  used_ = 0;
  room_ = 0;  // in case memory runs out below
  with_nearest_ = with_nearest;
  const std::int64_t most = in_steps(max_tiles);
  const auto make_room = [&](GrowingMemory& memory) {
    memory.reserve(bytes_of(most));
    memory.resize(std::min(memory.size(), bytes_of(most)));
    return tiles_in(memory.size());
  };
  std::int64_t room = make_room(values_);
  if (with_nearest)
    room = std::min(room, make_room(nearest_));
  else
    nearest_.release();
  room_ = room;
}

void TilePool::copy_from(const TilePool& other) {
  const std::int64_t tiles = other.size();
  grow(tiles);
  std::copy_n(other.values(0), tiles * DistanceField::kTileSamples, values(0));
  if (with_nearest_) std::copy_n(other.nearest(0), tiles * DistanceField::kTileSamples, nearest(0));
  used_ = tiles;
}

std::int64_t TilePool::add() {
  std::int64_t slot = used_;
  // Take a slot only when its memory is there: so a failure leaves the pool unchanged, whatever other threads do.
  do {
    if (slot >= room_) grow(slot + 1);
  } while (!used_.compare_exchange_weak(slot, slot + 1));
  return slot;
}

void TilePool::grow(std::int64_t tiles) {
  const std::lock_guard lock(growing_);
  if (tiles <= room_) return;
  const std::int64_t room = in_steps(tiles);
  const std::size_t bytes = bytes_of(room);
  if (bytes > values_.room() || (with_nearest_ && bytes > nearest_.room()))
    throw Error(ErrorCode::limit, "field: " + std::to_string(tiles) +
                                      " tiles need more memory addresses than this process may use; raise its limit "
                                      "(RLIMIT_AS), take fewer samples or a smaller thickness");
  // One of the arrays may be large enough from before.
  if (bytes > values_.size()) values_.resize(bytes);
  if (with_nearest_ && bytes > nearest_.size()) nearest_.resize(bytes);
  room_ = room;
}

double field_bytes(double stored_tiles, double all_tiles, bool with_nearest) {
  constexpr double kTileBytes = sizeof(float) * DistanceField::kTileSamples;
  // A field has fewer than 2^31 tiles; more fit no memory, so steps do not matter there.
  const double tiles = stored_tiles < 0x1p31
                           ? static_cast<double>(TilePool::in_steps(static_cast<std::int64_t>(stored_tiles)))
                           : stored_tiles;
  return tiles * kTileBytes * (with_nearest ? 2 : 1) + all_tiles * sizeof(std::int32_t);
}

std::string over_the_limit(double needed, double limit) {
  double unit = 1;
  const char* name = "B";
  for (const char* larger : {"KiB", "MiB"}) {
    const double in_larger = limit / (1024 * unit);
    if (in_larger < 10 && (in_larger < 1 || in_larger != std::floor(in_larger))) break;
    unit *= 1024;
    name = larger;
  }
  // Round away from each other, so that the texts differ.
  char text[96];
  std::snprintf(text, sizeof text, "%.0f %s, more than the limit of %.0f %s", std::ceil(needed / unit), name,
                std::floor(limit / unit), name);
  return text;
}

ErrorDetails limit_details(double needed, double limit) {
  const auto whole = [](double bytes) { return static_cast<std::int64_t>(std::min(bytes, 0x1p62)); };
  return {.bytes_needed = whole(std::ceil(needed)), .bytes_limit = whole(limit)};
}

}  // namespace standoff
