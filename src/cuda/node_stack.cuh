// Nodes of a tree that a warp has still to look at, in shared memory.
#pragma once

#include "cuda/body.cuh"

namespace difi::DIFI_PLATFORM {

// A packet of sixteen nodes in one word: its level above its place, which is below 2^28 for 2^32 triangles.
inline constexpr int kLevelShift = 28;
inline constexpr std::uint32_t kNoPacket = 0xffffffffu;
DIFI_DEVICE std::uint32_t packet_word(int level, std::uint32_t packet) {
  return static_cast<std::uint32_t>(level) << kLevelShift | packet;
}
DIFI_DEVICE int level_of(std::uint32_t word) { return static_cast<int>(word >> kLevelShift); }
DIFI_DEVICE std::uint32_t packet_of(std::uint32_t word) { return word & ((1u << kLevelShift) - 1); }

inline constexpr std::uint32_t kWarp = 0xffffffffu;
DIFI_DEVICE std::uint32_t lane_in_warp() { return threadIdx.x % 32; }
DIFI_DEVICE std::uint32_t lanes_below(std::uint32_t lane) { return (1u << lane) - 1; }

/// The same count in all lanes of a warp; all of them call all of it together.
class NodeStack {
 public:
  /// `words` is shared memory, room for `capacity`.
  DIFI_DEVICE NodeStack(std::uint32_t* words, int capacity, int top_level)
      : words_(words), capacity_(capacity), count_(1) {
    __syncwarp();
    if (lane_in_warp() == 0) words_[0] = packet_word(top_level, 0);
    __syncwarp();
  }
  DIFI_DEVICE bool empty() const { return count_ == 0; }
  DIFI_DEVICE std::uint32_t top() const { return words_[count_ - 1]; }

  /// Takes the uppermost packets, one for each half of the warp: kNoPacket for the second half where there is but one,
  /// or where the second is not above `least_level`.
  DIFI_DEVICE std::uint32_t take(int least_level) {
    const bool two = count_ > 1 && level_of(words_[count_ - 2]) >= least_level;
    const bool second = lane_in_warp() >= kLanes;
    const std::uint32_t word = !second ? words_[count_ - 1] : two ? words_[count_ - 2] : kNoPacket;
    count_ -= two ? 2 : 1;
    __syncwarp();  // all have read before anybody writes
    return word;
  }

  /// Puts the words of some lanes on top, that with the highest rank (0 to their number less one) uppermost. False, and
  /// nothing put, where there is no room.
  DIFI_DEVICE bool put(std::uint32_t lanes, int rank, std::uint32_t word) {
    const int more = __popc(lanes);
    if (count_ + more > capacity_) return false;
    if (lanes >> lane_in_warp() & 1) words_[count_ + rank] = word;
    count_ += more;
    __syncwarp();
    return true;
  }

 private:
  std::uint32_t* words_;
  int capacity_, count_;
};

}  // namespace difi::DIFI_PLATFORM
