// SPDX-License-Identifier: Apache-2.0
// Where a grammar's decisions come from: a random number generator, or the bytes of a fuzzer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace standoff::grammar {

/// Decisions that make one file. Choice 0 is always the plain one, so that where a fuzzer's bytes end, the file ends in
/// a plain way too.
///
/// There are two kinds. below() and one_in() choose among what a format allows: whatever they say, the file is good,
/// and what it holds is known. trick() says whether something may be written here that the format forbids; a file in
/// which it said yes may be read or refused, and nothing is known of its content.
class Choices {
 public:
  /// The same decisions for the same seed on every machine. Half of all seeds play no trick.
  explicit Choices(std::uint64_t seed);
  /// A fuzzer's bytes, which must outlive it. The first one says how often tricks are played.
  explicit Choices(std::span<const std::uint8_t> bytes);

  /// A number from 0 to n - 1. Requires n > 0.
  std::uint32_t below(std::uint32_t n);
  /// True once in n times.
  bool one_in(std::uint32_t n) { return below(n) == n - 1; }
  template <class T, std::size_t n>
  const T& pick(const T (&from)[n]) {
    return from[below(n)];
  }

  bool trick();
  /// Tricks played so far.
  int tricks() const { return tricks_; }

  /// How many of a thing to write where far too many are wanted: 10 mostly, rarely 100,000; in all of a file some
  /// hundred thousand.
  std::uint32_t many();

 private:
  std::uint32_t next(std::uint32_t n);

  bool from_bytes_ = false;
  std::span<const std::uint8_t> bytes_;
  std::uint64_t state_ = 0;
  std::uint32_t rarity_ = 0;  // one trick in so many places; 0: none
  int tricks_ = 0;
  std::uint32_t left_ = 300'000;  // of many()
};

}  // namespace standoff::grammar
