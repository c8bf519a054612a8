// SPDX-License-Identifier: Apache-2.0
// The stack of BVH nodes that a warp has still to visit, in shared memory.
#pragma once

#include "collision/cuda/device_model.cuh"

namespace standoff::STANDOFF_PLATFORM {

// A packet of sixteen nodes in one word: its level above its index, which is below 2^28 for 2^32 triangles.
inline constexpr int kLevelShift = 28;
inline constexpr std::uint32_t kNoPacket = 0xffffffffu;
STANDOFF_DEVICE std::uint32_t packet_word(int level, std::uint32_t packet) {
  return static_cast<std::uint32_t>(level) << kLevelShift | packet;
}
STANDOFF_DEVICE int level_of(std::uint32_t word) { return static_cast<int>(word >> kLevelShift); }
STANDOFF_DEVICE std::uint32_t packet_of(std::uint32_t word) { return word & ((1u << kLevelShift) - 1); }

inline constexpr std::uint32_t kWarp = 0xffffffffu;
STANDOFF_DEVICE std::uint32_t lane_in_warp() { return threadIdx.x % 32; }
STANDOFF_DEVICE std::uint32_t lanes_below(std::uint32_t lane) { return (1u << lane) - 1; }

/// A packet and the time from which its nodes are to be moved on.
struct TimedPacket {
  double time;
  std::uint32_t word;
};
STANDOFF_DEVICE std::uint32_t word_of(std::uint32_t entry) { return entry; }
STANDOFF_DEVICE std::uint32_t word_of(const TimedPacket& entry) { return entry.word; }

/// The same count in all lanes of a warp; all of them call all of it together.
template <class Entry>
class NodeStack {
 public:
  /// `entries` is shared memory for `capacity` of them.
  STANDOFF_DEVICE NodeStack(Entry* entries, int capacity, Entry first)
      : entries_(entries), capacity_(capacity), count_(1) {
    __syncwarp();
    if (lane_in_warp() == 0) entries_[0] = first;
    __syncwarp();
  }
  STANDOFF_DEVICE bool empty() const { return count_ == 0; }
  STANDOFF_DEVICE int top_level() const { return level_of(word_of(entries_[count_ - 1])); }

  /// Takes the uppermost packets, one for each half of the warp: `none` for the second half where there is but one, or
  /// where the second is below `least_level`.
  STANDOFF_DEVICE Entry take(int least_level, Entry none) {
    const bool two = count_ > 1 && level_of(word_of(entries_[count_ - 2])) >= least_level;
    const bool second = lane_in_warp() >= kLanes;
    const Entry entry = !second ? entries_[count_ - 1] : two ? entries_[count_ - 2] : none;
    count_ -= two ? 2 : 1;
    __syncwarp();  // all have read before anybody writes
    return entry;
  }

  /// Puts the entries of some lanes on top, that with the highest rank (0 to their number less one) uppermost. False,
  /// and nothing put, where they do not fit.
  STANDOFF_DEVICE bool put(std::uint32_t lanes, int rank, Entry entry) {
    const int more = __popc(lanes);
    if (count_ + more > capacity_) return false;
    if (lanes >> lane_in_warp() & 1) entries_[count_ + rank] = entry;
    count_ += more;
    __syncwarp();
    return true;
  }

 private:
  Entry* entries_;
  int capacity_, count_;
};

/// How many of some lanes hold a larger key, or as large a one in a later lane. `keys` is shared memory for 32.
template <class Key>
STANDOFF_DEVICE int larger_keys(std::uint32_t lanes, Key key, Key* keys) {
  const std::uint32_t lane = lane_in_warp();
  keys[lane] = key;
  __syncwarp();
  int larger = 0;
  for (std::uint32_t m = 0; m < 32; ++m)
    if (lanes >> m & 1) larger += keys[m] > key || (keys[m] == key && m > lane);
  __syncwarp();
  return larger;
}

}  // namespace standoff::STANDOFF_PLATFORM
