// SPDX-License-Identifier: Apache-2.0
// A list of boxes, of a length that is known beforehand.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>

#include "field/cpu/box_arrays.h"
#include "field/cpu/lattice.h"

namespace standoff::cpu {

/// There is always room for a whole register past the last entry, which the kernels may touch.
class BoxList {
 public:
  explicit BoxList(std::int64_t capacity)
      : sides_(std::make_unique_for_overwrite<float[]>(static_cast<std::size_t>(kSides * (capacity + kLanes)))),
        entries_(std::make_unique_for_overwrite<std::uint32_t[]>(static_cast<std::size_t>(capacity + kLanes))) {
    for (int axis = 0; axis < 3; ++axis) {
      arrays_.low[axis] = sides_.get() + axis * (capacity + kLanes);
      arrays_.high[axis] = sides_.get() + (3 + axis) * (capacity + kLanes);
    }
    arrays_.entry = entries_.get();
  }
  static constexpr std::int64_t bytes(std::int64_t capacity) {
    return (kSides * static_cast<std::int64_t>(sizeof(float)) + static_cast<std::int64_t>(sizeof(std::uint32_t))) *
           (capacity + kLanes);
  }

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
  void shrink(std::int64_t count) { arrays_.count = count; }
  void add(std::uint32_t entry, const BoxPack& boxes, int lane) {
    const std::int64_t at = arrays_.count++;
    for (int axis = 0; axis < 3; ++axis) {
      arrays_.low[axis][at] = boxes.low[axis][lane];
      arrays_.high[axis][at] = boxes.high[axis][lane];
    }
    arrays_.entry[at] = entry;
  }
  /// Adds entry n of another list.
  void add(const BoxList& other, std::int64_t n) { copy(other.arrays_, n, arrays_.count++); }
  /// Moves entry n to position `to`, not behind it.
  void move(std::int64_t n, std::int64_t to) { copy(arrays_, n, to); }

 private:
  static constexpr std::int64_t kSides = 6;

  void copy(const BoxArrays& from, std::int64_t n, std::int64_t to) {
    for (int axis = 0; axis < 3; ++axis) {
      arrays_.low[axis][to] = from.low[axis][n];
      arrays_.high[axis][to] = from.high[axis][n];
    }
    arrays_.entry[to] = from.entry[n];
  }

  BoxArrays arrays_{};
  std::unique_ptr<float[]> sides_;
  std::unique_ptr<std::uint32_t[]> entries_;
};

}  // namespace standoff::cpu
