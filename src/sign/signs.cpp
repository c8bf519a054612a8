// SPDX-License-Identifier: Apache-2.0
#include "sign/signs.h"

#include <array>
#include <cstring>

#include "core/tile_count.h"

namespace standoff {

std::int64_t InsideRows::bytes(const Grid& grid) { return kRows * tiles_along(grid.size.x); }

InsideRows::InsideRows(const Grid& grid, const Grid& window)
    : size_(grid.size),
      begin_((window.first.x - grid.first.x) / kSide),
      bits_(static_cast<std::size_t>(bytes(window))) {
  size_.x = window.first.x - grid.first.x + window.size.x;
}

void InsideRows::clear(std::int64_t ty, std::int64_t tz) {
  rows_y_ = std::min<std::int64_t>(kSide, size_.y - kSide * ty);
  rows_z_ = std::min<std::int64_t>(kSide, size_.z - kSide * tz);
  if (first_tile_ < end_of_tiles_)
    std::fill(bits_.data() + place(first_tile_), bits_.data() + place(end_of_tiles_), std::uint8_t{0});
  first_tile_ = tiles_end();
  end_of_tiles_ = 0;
}

void InsideRows::set(int row, std::int64_t begin, std::int64_t end) {
  begin = std::max(begin, kSide * begin_);
  end = std::min(end, size_.x);
  if (begin >= end) return;
  const std::int64_t first = begin / kSide, last = (end - 1) / kSide;
  first_tile_ = std::min(first_tile_, first);
  end_of_tiles_ = std::max(end_of_tiles_, last + 1);
  const auto head = static_cast<std::uint8_t>(0xff << (begin % kSide)),
             tail = static_cast<std::uint8_t>(0xff >> (kSide - 1 - (end - 1) % kSide));
  const auto at = [&](std::int64_t tx) -> std::uint8_t& { return bits_[place(tx) + static_cast<std::size_t>(row)]; };
  if (first == last) {
    at(first) |= head & tail;
    return;
  }
  at(first) |= head;
  for (std::int64_t tx = first + 1; tx < last; ++tx) at(tx) = 0xff;
  at(last) |= tail;
}

// Carries the last sample of each tile into the next tile of its row.
void InsideRows::finish_toggles() {
  using Rows = std::int8_t __attribute__((vector_size(16)));
  const std::int64_t tiles = tiles_end();
  std::array<Rows, kRows / sizeof(Rows)> before{};
  for (std::int64_t tx = first_tile_; tx < tiles; ++tx) {
    std::uint8_t* const bytes = bits_.data() + place(tx);
    for (Rows& rows : before) {
      std::uint8_t* const here = bytes + sizeof(Rows) * static_cast<std::size_t>(&rows - before.data());
      Rows toggled;
      std::memcpy(&toggled, here, sizeof toggled);
      rows = toggled ^ (rows < 0);
      std::memcpy(here, &rows, sizeof rows);
    }
  }
  if (first_tile_ == tiles) return;
  end_of_tiles_ = tiles;
  // Put all beyond the grid outside.
  if (const std::int64_t last = samples_along_x(tiles - 1); last < kSide)
    for (std::uint8_t& byte : tile(tiles - 1)) byte &= static_cast<std::uint8_t>(0xff >> (kSide - last));
}

void InsideRows::invert() {
  first_tile_ = begin_;
  end_of_tiles_ = tiles_end();
  for (std::int64_t tx = begin_; tx < end_of_tiles_; ++tx)
    for (int row = 0; row < kRows; ++row) tile(tx)[static_cast<std::size_t>(row)] ^= full_byte(row, tx);
}

bool InsideRows::is_empty(std::int64_t tx) const {
  unsigned any = 0;
  for (const std::uint8_t byte : tile(tx)) any |= byte;
  return any == 0;
}

bool InsideRows::is_full(std::int64_t tx) const {
  unsigned missing = 0;
  if (rows_y_ == kSide && rows_z_ == kSide && samples_along_x(tx) == kSide) {
    for (const std::uint8_t byte : tile(tx)) missing |= byte ^ 0xffu;
  } else {
    for (int row = 0; row < kRows; ++row)
      missing |= tile(tx)[static_cast<std::size_t>(row)] ^ unsigned { full_byte(row, tx) };
  }
  return missing == 0;
}

}  // namespace standoff
