// SPDX-License-Identifier: Apache-2.0
// Small kernels that keep the outcome, and lists of tiles.
#pragma once

#include "field/cuda/bin.cuh"

namespace standoff::STANDOFF_PLATFORM {

STANDOFF_KERNEL void clear_outcome(Outcome* outcome, Counter* counters, int count) {
  *outcome = {0, Outcome::kNone, 0, 0, 0, 0};
  for (int n = 0; n < count; ++n) counters[n] = 0;
}

/// Stops all that follows where the lists do not fit.
STANDOFF_KERNEL void check_entries(const Counter* total, Counter capacity, Outcome* outcome) {
  if (*total > outcome->needed_entries) outcome->needed_entries = *total;
  if (*total > capacity) stop(outcome);
}

/// 1 for each tile with triangles, 0 behind the last.
STANDOFF_KERNEL void mark_used_tiles(const Counter* start, std::int64_t tiles, std::uint32_t* used) {
  const std::int64_t tile = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (tile <= tiles) used[tile] = tile < tiles && start[tile + 1] > start[tile];
}

/// From the running sum of `used`: each tile's slot or -1, if there are slots for all. A thread a tile.
STANDOFF_KERNEL void give_slots(const std::uint32_t* used, const Counter* rank, std::int64_t tiles, DeviceOutput output,
                                Outcome* outcome) {
  const std::int64_t tile = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (tile > tiles) return;
  const Counter needed = rank[tiles];
  const bool fits = needed <= static_cast<Counter>(output.slot_capacity);
  if (tile == tiles) {
    outcome->needed_slots = needed;
    if (!fits) stop(outcome);
    return;
  }
  if (!fits || outcome->stopped) return;
  output.slots[tile] = used[tile] ? static_cast<std::int32_t>(rank[tile]) : -1;
}

}  // namespace standoff::STANDOFF_PLATFORM
