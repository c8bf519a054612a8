// A list of boxes that grows.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>

#include "cpu/box_arrays.h"
#include "cpu/lattice.h"

namespace difi::cpu {

/// A list that grows to what it is asked to hold and keeps its memory. There is always room for a whole register past
/// the last entry, which the kernels may touch.
class BoxList {
 public:
  std::int64_t size() const { return arrays_.count; }
  std::uint32_t entry(std::int64_t n) const { return arrays_.entry[n]; }
  float longest_side(std::int64_t n) const {
    return std::max({arrays_.high[0][n] - arrays_.low[0][n], arrays_.high[1][n] - arrays_.low[1][n],
                     arrays_.high[2][n] - arrays_.low[2][n]});
  }
  const BoxArrays& arrays() const { return arrays_; }
  /// For kernels that add to the list.
  BoxArrays& arrays() { return arrays_; }

  void clear() { arrays_.count = 0; }
  void add(std::uint32_t entry, const BoxPack& boxes, int lane) {
    const std::int64_t at = arrays_.count++;
    for (int axis = 0; axis < 3; ++axis) {
      arrays_.low[axis][at] = boxes.low[axis][lane];
      arrays_.high[axis][at] = boxes.high[axis][lane];
    }
    arrays_.entry[at] = entry;
  }
  /// Moves entry n to position `to`, not behind it.
  void move(std::int64_t n, std::int64_t to) {
    for (int axis = 0; axis < 3; ++axis) {
      arrays_.low[axis][to] = arrays_.low[axis][n];
      arrays_.high[axis][to] = arrays_.high[axis][n];
    }
    arrays_.entry[to] = arrays_.entry[n];
  }

  /// Makes room for `more` entries behind those there are.
  void make_room(std::int64_t more) {
    const std::int64_t needed = arrays_.count + more + kLanes;
    if (needed <= stride_) return;
    const std::int64_t stride = needed + needed / 2;
    auto memory = std::make_unique_for_overwrite<float[]>(static_cast<std::size_t>(6 * stride));
    auto entries = std::make_unique_for_overwrite<std::uint32_t[]>(static_cast<std::size_t>(stride));
    for (int axis = 0; axis < 3; ++axis) {
      arrays_.low[axis] = moved(arrays_.low[axis], memory.get() + axis * stride);
      arrays_.high[axis] = moved(arrays_.high[axis], memory.get() + (3 + axis) * stride);
    }
    arrays_.entry = moved(arrays_.entry, entries.get());
    memory_ = std::move(memory);
    entries_ = std::move(entries);
    stride_ = stride;
  }

 private:
  template <class T>
  T* moved(const T* from, T* to) const {
    std::copy(from, from + arrays_.count, to);
    return to;
  }

  BoxArrays arrays_{};
  std::int64_t stride_ = 0;
  std::unique_ptr<float[]> memory_;
  std::unique_ptr<std::uint32_t[]> entries_;
};

}  // namespace difi::cpu
