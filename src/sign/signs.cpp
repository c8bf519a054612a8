// SPDX-License-Identifier: Apache-2.0
#include "sign/signs.h"

#include <algorithm>
#include <cstring>
#include <iterator>

#include "core/tile_count.h"
#include "sign/cpu/kernels.h"

namespace standoff {

std::int64_t InsideRows::bytes(const Grid& grid) {
  constexpr std::int64_t kBits = kRows, kSteps = kRows * kSide + 1, kStepsOfRow = kSide * sizeof(std::int32_t);
  return (kBits + kSteps + kStepsOfRow) * tiles_along(grid.size.x);
}

InsideRows::InsideRows(const Grid& grid, const Grid& window)
    : size_(grid.size),
      begin_((window.first.x - grid.first.x) / kSide),
      bits_(static_cast<std::size_t>(kRows * tiles_along(window.size.x))) {
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

void InsideRows::begin_steps() {
  if (!steps_.empty()) return;
  steps_.resize(kSide * bits_.size());
  is_stepped_.resize(bits_.size() / kRows);
}

void InsideRows::finish_steps(WindingRule rule) {
  const auto [first, end] =
      cpu::sign_kernels_for(Simd::automatic)
          .mark_inside(steps_.data(), is_stepped_.data(), std::ssize(is_stepped_), rule, bits_.data());
  first_tile_ = begin_ + first;
  end_of_tiles_ = begin_ + end;
  // Put all beyond the grid outside.
  if (const std::int64_t last = samples_along_x(tiles_end() - 1); last < kSide && end_of_tiles_ == tiles_end())
    for (std::uint8_t& byte : tile(tiles_end() - 1)) byte &= static_cast<std::uint8_t>(0xff >> (kSide - last));
}

void InsideRows::drop_steps() {
  std::ranges::fill(steps_, std::int8_t{0});
  std::ranges::fill(is_stepped_, std::uint8_t{0});
}

void InsideRows::invert() {
  first_tile_ = begin_;
  end_of_tiles_ = tiles_end();
  for (std::int64_t tx = begin_; tx < end_of_tiles_; ++tx)
    for (int row = 0; row < kRows; ++row) tile(tx)[static_cast<std::size_t>(row)] ^= full_byte(row, tx);
}

bool InsideRows::is_empty(std::int64_t tx) const {
  std::uint64_t any = 0;
  for (const std::uint64_t eight : words(tx)) any |= eight;
  return any == 0;
}

bool InsideRows::is_full(std::int64_t tx) const {
  std::uint64_t missing = 0;
  if (rows_y_ == kSide && rows_z_ == kSide && samples_along_x(tx) == kSide) {
    for (const std::uint64_t eight : words(tx)) missing |= ~eight;
  } else {
    for (int row = 0; row < kRows; ++row)
      missing |= tile(tx)[static_cast<std::size_t>(row)] ^ unsigned { full_byte(row, tx) };
  }
  return missing == 0;
}

std::array<std::uint64_t, InsideRows::kRows / 8> InsideRows::words(std::int64_t tx) const {
  std::array<std::uint64_t, kRows / 8> words;
  std::memcpy(words.data(), tile(tx).data(), sizeof words);
  return words;
}

}  // namespace standoff
