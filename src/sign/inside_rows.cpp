// SPDX-License-Identifier: Apache-2.0
#include "sign/inside_rows.h"

#include <algorithm>

#include "core/tile_count.h"

namespace standoff {

InsideRows::InsideRows(const Grid& grid, const SignOptions& options)
    : size_(grid.size), options_(options), bits_(static_cast<std::size_t>(64 * tiles_along(size_.x))) {}

bool InsideRows::fill(std::span<const RowCrossing> crossings, std::int64_t ty, std::int64_t tz) {
  rows_y_ = std::min<std::int64_t>(8, size_.y - 8 * ty);
  rows_z_ = std::min<std::int64_t>(8, size_.z - 8 * tz);
  std::ranges::fill(bits_, std::uint8_t{0});
  bool any = false;
  auto next = crossings.begin();
  for (int row = 0; row < 64; ++row) {
    if (!in_grid(row)) continue;
    std::int32_t winding = 0;
    std::int64_t from = 0;
    for (; next != crossings.end() && next->row() == row; ++next) {
      if (next->past() != from && is_inside(winding)) set(row, from, next->past()), any = true;
      from = next->past();
      winding += next->step();
    }
    if (from < size_.x && is_inside(winding)) set(row, from, size_.x), any = true;
  }
  return any;
}

bool InsideRows::is_full(std::int64_t tx) const {
  const std::int64_t count = std::min<std::int64_t>(8, size_.x - 8 * tx);
  const auto all = static_cast<std::uint8_t>(0xff >> (8 - count));
  for (int row = 0; row < 64; ++row)
    if (in_grid(row) && byte(row, tx) != all) return false;
  return true;
}

bool InsideRows::is_inside(std::int32_t winding) const {
  const bool odd = options_.method == SignMethod::parity || options_.rule == WindingRule::odd;
  const bool inside = odd ? (winding & 1) != 0 : options_.rule == WindingRule::nonzero ? winding != 0 : winding > 0;
  return inside != options_.invert;
}

void InsideRows::set(int row, std::int64_t begin, std::int64_t end) {
  const std::int64_t first = begin / 8, last = (end - 1) / 8;
  const auto head = static_cast<std::uint8_t>(0xff << (begin % 8)),
             tail = static_cast<std::uint8_t>(0xff >> (7 - (end - 1) % 8));
  const auto at = [&](std::int64_t tx) -> std::uint8_t& { return bits_[static_cast<std::size_t>(64 * tx + row)]; };
  if (first == last) {
    at(first) |= head & tail;
    return;
  }
  at(first) |= head;
  for (std::int64_t tx = first + 1; tx < last; ++tx) at(tx) = 0xff;
  at(last) |= tail;
}

}  // namespace standoff
