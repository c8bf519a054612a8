// SPDX-License-Identifier: Apache-2.0
#include "sign/signs.h"

#include <algorithm>
#include <cstring>
#include <iterator>

#include "core/tile_count.h"
#include "sign/cpu/kernels.h"
#include "sign/rows/row_crossings.h"
#include "simd/dispatch.h"

namespace standoff {

std::int64_t InsideRows::bytes(const Grid& grid) {
  constexpr std::int64_t kBits = kRows, kSteps = kRows * kSide + 1;
  return (kBits + kSteps) * tiles_along(grid.size.x);
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

void InsideRows::fill_between(std::span<const RowCrossing> crossings, WindingRule rule) {
  if (crossings.empty()) return;
  if (!add_steps(crossings, rule)) {
    std::ranges::fill(steps_, std::int8_t{0});
    std::ranges::fill(is_stepped_, std::uint8_t{0});
    std::vector<RowCrossing> sorted(crossings.begin(), crossings.end());
    std::ranges::sort(sorted);
    std::int32_t winding = 0;
    for (std::size_t n = 0; n < sorted.size(); ++n) {
      const int row = sorted[n].row();
      const bool last = n + 1 == sorted.size() || sorted[n + 1].row() != row;
      winding += sorted[n].step();
      if (standoff::is_inside(winding, rule)) set(row, sorted[n].past(), last ? size_.x : sorted[n + 1].past());
      if (last) winding = 0;
    }
    return;
  }
  const auto [first, end] = dispatch_of<cpu::SignKernels>().best().mark_inside(
      steps_.data(), is_stepped_.data(), std::ssize(is_stepped_), rule, bits_.data());
  first_tile_ = begin_ + first;
  end_of_tiles_ = begin_ + end;
  // Put all beyond the grid outside.
  if (const std::int64_t last = samples_along_x(tiles_end() - 1); last < kSide && end_of_tiles_ == tiles_end())
    for (std::uint8_t& byte : tile(tiles_end() - 1)) byte &= static_cast<std::uint8_t>(0xff >> (kSide - last));
}

// Adds the step at each crossing to that of its sample, a byte. Returns false where the winding numbers of a row may
// need more than a byte.
bool InsideRows::add_steps(std::span<const RowCrossing> crossings, WindingRule rule) {
  steps_.resize(kSide * bits_.size());
  is_stepped_.resize(bits_.size() / kRows);
  // Winding numbers of a row are from -leaves to enters. Odd ones stay odd where a byte overflows.
  std::array<std::int64_t, kRows> enters{}, leaves{};
  // Bytes may be anything to a compiler, also the members: copy these.
  std::int8_t* const steps = steps_.data();
  std::uint8_t* const is_stepped = is_stepped_.data();
  const std::int64_t begin = kSide * begin_, end = size_.x;
  for (const RowCrossing& crossing : crossings) {
    const auto row = static_cast<std::size_t>(crossing.row());
    const std::int64_t from = std::max(crossing.past(), begin);
    if (from >= end) continue;
    const auto n = static_cast<std::size_t>(from - begin);
    is_stepped[n / kSide] = 1;
    steps[kRows * n + row] = static_cast<std::int8_t>(steps[kRows * n + row] + crossing.step());
    (crossing.step() > 0 ? enters : leaves)[row] += std::abs(crossing.step());
  }
  return rule == WindingRule::odd ||
         std::max(std::ranges::max(enters), std::ranges::max(leaves)) <= std::numeric_limits<std::int8_t>::max();
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
