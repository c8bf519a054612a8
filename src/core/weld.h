// SPDX-License-Identifier: Apache-2.0
// Exact welding: equal positions become one vertex. It is parallel, and its result does not depend on the threads.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/hashes.h"
#include "standoff/vec.h"

namespace standoff {

/// The most positions that can be welded: numbers are 32-bit and one value marks free slots.
inline constexpr std::uint64_t kMaxWeld = std::numeric_limits<std::uint32_t>::max() - 1;

/// Adding this to a position turns -0 into +0 and changes nothing else: so a welded vertex has the same bits, whichever
/// of several equal positions came first.
inline constexpr Vec3 kPositiveZero{0, 0, 0};

namespace weld_detail {

// First the positions of a block are welded among themselves, in a table that stays in the second-level cache: files
// list neighbouring triangles together, so most duplicates never reach the shared table.
constexpr std::uint32_t kBlock = 1 << 14;
constexpr std::uint32_t kFree = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kAhead = 24;  // slots are prefetched this many positions ahead

// Compares bits, so that a NaN equals itself and a million of them do not become a million slots in a row.
inline bool same(Vec3 a, Vec3 b) {
  return position_bits(a.x) == position_bits(b.x) && position_bits(a.y) == position_bits(b.y) &&
         position_bits(a.z) == position_bits(b.z);
}

template <class Body>
void for_each_block(std::uint32_t count, const Body& body) {
  const std::uint32_t blocks = count / kBlock + (count % kBlock != 0);
  tbb::parallel_for(std::uint32_t{0}, blocks, [&](std::uint32_t b) {
    const std::uint32_t begin = b * kBlock;
    body(b, begin, begin + std::min(kBlock, count - begin));
  });
}

// Sets first[i] to the first equal position in i's block; returns the number of distinct positions of the block.
template <class Position>
std::uint32_t weld_block(std::uint32_t begin, std::uint32_t end, const Position& position, std::uint32_t* first) {
  constexpr std::uint16_t free = 0xffff;
  constexpr std::size_t size = 2 * kBlock;
  std::array<std::uint16_t, size> table;
  table.fill(free);
  std::uint32_t distinct = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const Vec3 p = position(i);
    std::size_t slot = position_hash(p) % size;
    while (table[slot] != free && !same(position(begin + table[slot]), p)) slot = (slot + 1) % size;
    if (table[slot] == free) {
      table[slot] = static_cast<std::uint16_t>(i - begin);
      ++distinct;
    }
    first[i] = begin + table[slot];
  }
  return distinct;
}

// A slot holds the lowest number of all equal positions so far. Its position never changes, and its number only falls:
// so the threads decide nothing but the choice of slots, which no result depends on.
template <class Position>
class SharedTable {
 public:
  SharedTable(std::uint64_t distinct, const Position& position)
      : position_(position), mask_(std::min(std::bit_ceil(distinct + distinct / 2 + 1), std::uint64_t{1} << 32) - 1) {
    slots_ = std::make_unique_for_overwrite<std::uint32_t[]>(mask_ + 1);
    tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, mask_ + 1, kBlock), [&](const auto& range) {
      std::fill(slots_.get() + range.begin(), slots_.get() + range.end(), kFree);
    });
  }

  void prefetch(std::uint32_t i) const { __builtin_prefetch(&slots_[home(position_(i))]); }

  std::uint32_t insert(std::uint32_t i) {
    const Vec3 p = position_(i);
    for (std::uint64_t slot = home(p);; slot = (slot + 1) & mask_) {
      auto number = at(slot);
      std::uint32_t seen = number.load(std::memory_order_relaxed);
      if (seen == kFree && number.compare_exchange_strong(seen, i, std::memory_order_relaxed))
        return static_cast<std::uint32_t>(slot);
      if (!same(position_(seen), p)) continue;
      while (i < seen && !number.compare_exchange_weak(seen, i, std::memory_order_relaxed)) {
      }
      return static_cast<std::uint32_t>(slot);
    }
  }

  std::uint32_t get(std::uint32_t slot) const { return at(slot).load(std::memory_order_relaxed); }
  void set(std::uint32_t slot, std::uint32_t number) { at(slot).store(number, std::memory_order_relaxed); }

 private:
  std::uint64_t home(Vec3 p) const { return position_hash(p) & mask_; }
  std::atomic_ref<std::uint32_t> at(std::uint64_t slot) const { return std::atomic_ref(slots_[slot]); }

  const Position& position_;
  std::uint64_t mask_;
  std::unique_ptr<std::uint32_t[]> slots_;
};

}  // namespace weld_detail

/// Numbers the distinct positions, of vertex.size(), in the order of their first appearance: vertex[i] becomes the
/// number of position(i); two numbers are equal if and only if the positions are (-0 equals +0). Returns the number of
/// distinct positions. So vertex[i] equals the number of distinct positions before i if and only if position(i) is new.
/// `position(i)` returns a Vec3, always the same one, from any thread. Requires vertex.size() <= kMaxWeld.
/// Linear; up to 12 bytes of scratch per position that is new in its block.
/// `check()` is called now and then, from any thread; an exception from it ends the work.
template <class Position, class Check>
std::uint32_t weld(const Position& position, std::span<std::uint32_t> vertex, const Check& check) {
  using namespace weld_detail;
  const auto count = static_cast<std::uint32_t>(vertex.size());
  const auto for_each_block = [&](std::uint32_t positions, const auto& body) {
    weld_detail::for_each_block(positions, [&](std::uint32_t block, std::uint32_t begin, std::uint32_t end) {
      check();
      body(block, begin, end);
    });
  };
  std::atomic<std::uint64_t> distinct = 0;
  for_each_block(count, [&](std::uint32_t, std::uint32_t begin, std::uint32_t end) {
    distinct += weld_block(begin, end, position, vertex.data());
  });

  SharedTable<Position> table(distinct, position);
  std::vector<std::uint32_t> new_in_block(count / kBlock + 1);
  for_each_block(count, [&](std::uint32_t, std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) {
      if (end - i > kAhead && vertex[i + kAhead] == i + kAhead) table.prefetch(i + kAhead);
      // All entries below i hold slots by now.
      vertex[i] = vertex[i] == i ? table.insert(i) : vertex[vertex[i]];
    }
  });

  for_each_block(count, [&](std::uint32_t block, std::uint32_t begin, std::uint32_t end) {
    std::uint32_t fresh = 0;
    for (std::uint32_t i = begin; i < end; ++i) fresh += table.get(vertex[i]) == i;
    new_in_block[block] = fresh;
  });
  std::uint32_t total = 0;
  for (std::uint32_t& fresh : new_in_block) total += std::exchange(fresh, total);

  // The number that replaces i is at most i, and all other positions of the slot come after i: so none mistakes it for
  // its own.
  for_each_block(count, [&](std::uint32_t block, std::uint32_t begin, std::uint32_t end) {
    std::uint32_t next = new_in_block[block];
    for (std::uint32_t i = begin; i < end; ++i)
      if (table.get(vertex[i]) == i) table.set(vertex[i], next++);
  });
  for_each_block(count, [&](std::uint32_t, std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) vertex[i] = table.get(vertex[i]);
  });
  return total;
}
template <class Position>
std::uint32_t weld(const Position& position, std::span<std::uint32_t> vertex) {
  return weld(position, vertex, [] {});
}

}  // namespace standoff
