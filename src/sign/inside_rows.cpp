// SPDX-License-Identifier: Apache-2.0
#include "sign/inside_rows.h"

#include "core/tile_count.h"

namespace standoff {

InsideRows::InsideRows(const Grid& grid)
    : size_(grid.size), bits_(static_cast<std::size_t>(kRows * tiles_along(grid.size.x))) {}

void InsideRows::clear(std::int64_t ty, std::int64_t tz) {
  rows_y_ = std::min<std::int64_t>(kSide, size_.y - kSide * ty);
  rows_z_ = std::min<std::int64_t>(kSide, size_.z - kSide * tz);
  std::ranges::fill(bits_, std::uint8_t{0});
}

void InsideRows::set(int row, std::int64_t begin, std::int64_t end) {
  const std::int64_t first = begin / kSide, last = (end - 1) / kSide;
  const auto head = static_cast<std::uint8_t>(0xff << (begin % kSide)),
             tail = static_cast<std::uint8_t>(0xff >> (kSide - 1 - (end - 1) % kSide));
  const auto at = [&](std::int64_t tx) -> std::uint8_t& { return bits_[static_cast<std::size_t>(kRows * tx + row)]; };
  if (first == last) {
    at(first) |= head & tail;
    return;
  }
  at(first) |= head;
  for (std::int64_t tx = first + 1; tx < last; ++tx) at(tx) = 0xff;
  at(last) |= tail;
}

void InsideRows::invert() {
  for (std::int64_t tx = 0; tx < tiles_along(size_.x); ++tx)
    for (int row = 0; row < kRows; ++row) tile(tx)[static_cast<std::size_t>(row)] ^= full_byte(row, tx);
}

bool InsideRows::is_empty(std::int64_t tx) const {
  return std::ranges::all_of(tile(tx), [](std::uint8_t byte) { return byte == 0; });
}

bool InsideRows::is_full(std::int64_t tx) const {
  for (int row = 0; row < kRows; ++row)
    if (tile(tx)[static_cast<std::size_t>(row)] != full_byte(row, tx)) return false;
  return true;
}

}  // namespace standoff
