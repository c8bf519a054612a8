// SPDX-License-Identifier: Apache-2.0
// The memory of a field's stored tiles: one array of values and one of nearest triangles, a slot for each tile.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

#include "core/growing_memory.h"
#include "standoff/field.h"

namespace standoff {

/// Slots never move, so threads can fill tiles while others add some.
class TilePool {
 public:
  /// Tiles for which there is memory when so many are stored. Small fields take 512 KiB of values at a time; past 2 MiB
  /// whole huge pages are taken, whose pages cost a tenth of small ones.
  static std::int64_t in_steps(std::int64_t tiles) {
    constexpr std::int64_t kHugePage = GrowingMemory::kHugePage / (sizeof(float) * DistanceField::kTileSamples);
    const std::int64_t step = tiles <= kHugePage ? kHugePage / 4 : kHugePage;
    return (tiles + step - 1) / step * step;
  }

  /// Forgets all tiles. Memory that is there stays for the next ones, as far as so many may use it.
  void clear(std::int64_t max_tiles, bool with_nearest);
  /// Makes an empty pool a copy of the tiles of another.
  void copy_from(const TilePool& other);

  /// A new slot; its values and nearest triangles mean nothing yet. Safe from many threads. Throws std::bad_alloc, or
  /// Error{limit} where the process may not use more addresses; the pool is then as it was.
  std::int64_t add();
  /// Gives back the memory of the nearest triangles.
  void release_nearest() {
    with_nearest_ = false;
    nearest_.release();
  }
  /// Forgets the last slot.
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
  std::atomic<std::int64_t> room_{0};  // tiles for which there is memory
  std::mutex growing_;
};

}  // namespace standoff
