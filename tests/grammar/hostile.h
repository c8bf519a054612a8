// SPDX-License-Identifier: Apache-2.0
// What breaks readers: numbers, names and bytes as no good file has them. Each function writes the plain thing unless a
// trick is played.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>

#include "tests/grammar/choices.h"

namespace standoff::grammar {

/// A whole number in decimals.
std::string whole(Choices& c, std::int64_t value);
/// The shortest decimals that read as this number, with an exponent or without.
std::string real(Choices& c, double value);
/// A word of a header or a name.
std::string word(Choices& c, const std::string& plain);
/// At a trick, something a text reader may stumble on, to stand between two words; else nothing.
std::string noise(Choices& c);
/// At a trick cuts, repeats or overwrites parts.
void damage(Choices& c, std::string& bytes);
/// A word that no number is, or one past every range.
std::string bad_number(Choices& c);
/// A URI or path to something that must not be opened: a pipe, a folder, a device, a file outside.
std::string bad_path(Choices& c);

/// The bytes of a number, little endian; at a trick those of an extreme one.
template <class T>
std::string raw(T value, bool big_endian = false) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  return big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}
template <class T>
T stored(Choices& c, T value) {
  if (!c.trick()) return value;
  using L = std::numeric_limits<T>;
  if constexpr (std::is_floating_point_v<T>) {
    const T bad[] = {L::quiet_NaN(), L::infinity(),   -L::infinity(), L::max(),
                     -L::max(),      L::denorm_min(), T(-0.0),        T(0)};
    return c.pick(bad);
  } else {
    const auto near = static_cast<std::uint64_t>(value);  // sums of which go round
    const T bad[] = {T(0),
                     T(1),
                     T(-1),
                     L::max(),
                     L::min(),
                     T(L::max() / 2),
                     T(L::max() / 2 + 1),
                     T(L::max() / 3),
                     T(near + 1),
                     T(near - 1),
                     T(near * 2),
                     T(65535),
                     T(1u << 20),
                     T(1u << 30)};
    return c.pick(bad);
  }
}

}  // namespace standoff::grammar
