// SPDX-License-Identifier: Apache-2.0
#include "tests/grammar/choices.h"

#include <algorithm>

#include "core/hashes.h"

namespace standoff::grammar {
namespace {

// From one trick in two places, which leaves nothing whole, to one in a thousand, which most files do not see.
std::uint32_t rarity_of(std::uint32_t choice) { return 2u << choice % 10; }

}  // namespace

// Mixed first: neighbouring seeds must begin far from each other.
Choices::Choices(std::uint64_t seed) : state_(splitmix64(seed)) {
  if (below(2) == 1) rarity_ = rarity_of(below(10));
}

Choices::Choices(std::span<const std::uint8_t> bytes) : from_bytes_(true), bytes_(bytes) {
  if (const std::uint32_t first = below(11); first > 0) rarity_ = rarity_of(first - 1);
}

std::uint32_t Choices::below(std::uint32_t n) { return n == 1 ? 0 : next(n) % n; }

bool Choices::trick() {
  if (rarity_ == 0 || below(rarity_) != rarity_ - 1) return false;
  ++tricks_;
  return true;
}

std::uint32_t Choices::many() {
  const std::uint32_t luck = below(200);
  const std::uint32_t wanted = luck < 120 ? 10 : luck < 180 ? 100 : luck < 197 ? 1000 : luck < 199 ? 10'000 : 100'000;
  const std::uint32_t given = std::min(wanted, left_);
  left_ -= given;
  return given;
}

// Of a fuzzer as few bytes as hold n.
std::uint32_t Choices::next(std::uint32_t n) {
  if (!from_bytes_) {
    const std::uint64_t bits = splitmix64(state_);
    state_ += kSplitmixStep;
    return static_cast<std::uint32_t>(bits >> 32);
  }
  std::uint32_t number = 0;
  const std::size_t wanted = n <= 0x100 ? 1 : n <= 0x10000 ? 2 : 4, taken = std::min(wanted, bytes_.size());
  for (std::size_t k = 0; k < taken; ++k) number = number << 8 | bytes_[k];
  bytes_ = bytes_.subspan(taken);
  return number;
}

}  // namespace standoff::grammar
