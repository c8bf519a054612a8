// Boxes of entries, an array per coordinate, as the culling kernels read and write them.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>

#include "cpu/clusters.h"
#include "cpu/kernels.h"
#include "cpu/lattice.h"

namespace difi::cpu {

/// A list that grows to what it is asked to hold and keeps its memory. There is always room for a whole register past
/// the last entry, which the kernels may touch.
class BoxList {
 public:
  BoxList() = default;
  explicit BoxList(std::int64_t room) { clear_for(room); }

  std::int64_t size() const { return arrays_.count; }
  std::uint32_t entry(std::int64_t n) const { return arrays_.entry[n]; }
  const BoxArrays& arrays() const { return arrays_; }
  /// For kernels that fill the list: they set the count.
  BoxArrays& arrays() { return arrays_; }

  /// Forgets all entries and makes room for this many.
  void clear_for(std::int64_t room) {
    arrays_.count = 0;
    if (room + kLanes <= stride_) return;
    stride_ = room + room / 2 + kLanes;
    memory_ = std::make_unique_for_overwrite<float[]>(static_cast<std::size_t>(6 * stride_));
    entries_ = std::make_unique_for_overwrite<std::uint32_t[]>(static_cast<std::size_t>(stride_));
    for (int axis = 0; axis < 3; ++axis) {
      arrays_.low[axis] = memory_.get() + axis * stride_;
      arrays_.high[axis] = memory_.get() + (3 + axis) * stride_;
    }
    arrays_.entry = entries_.get();
  }

  /// Adds a pack's boxes as entries first, first + 1, ... The room for all eight must be there.
  void add(const Clusters::Children& pack) {
    const std::int64_t at = arrays_.count;
    for (int axis = 0; axis < 3; ++axis) {
      std::memcpy(arrays_.low[axis] + at, pack.boxes->low[axis], sizeof pack.boxes->low[axis]);
      std::memcpy(arrays_.high[axis] + at, pack.boxes->high[axis], sizeof pack.boxes->high[axis]);
    }
    for (int n = 0; n < Clusters::kFanout; ++n) arrays_.entry[at + n] = pack.first + static_cast<std::uint32_t>(n);
    arrays_.count = at + pack.count;
  }

  /// Adds entry n of another list.
  void add(const BoxArrays& from, std::int64_t n) {
    const std::int64_t at = arrays_.count++;
    for (int axis = 0; axis < 3; ++axis) {
      arrays_.low[axis][at] = from.low[axis][n];
      arrays_.high[axis][at] = from.high[axis][n];
    }
    arrays_.entry[at] = from.entry[n];
  }

 private:
  BoxArrays arrays_{};
  std::int64_t stride_ = 0;
  std::unique_ptr<float[]> memory_;
  std::unique_ptr<std::uint32_t[]> entries_;
};

}  // namespace difi::cpu
