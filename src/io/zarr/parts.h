// SPDX-License-Identifier: Apache-2.0
// Counting samples in chunks, and chunks in shards.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "standoff/vec.h"

namespace standoff::zarr {

/// How many parts cover so many samples.
constexpr std::int64_t parts_of(std::int64_t samples, std::int64_t part) { return (samples + part - 1) / part; }
constexpr Size3 parts_of(const Size3& samples, const Size3& part) {
  return {parts_of(samples.x, part.x), parts_of(samples.y, part.y), parts_of(samples.z, part.z)};
}
constexpr Size3 times(const Size3& a, const Size3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
constexpr Size3 plus(const Size3& a, const Size3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Size3 least(const Size3& a, const Size3& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}

/// Part n of a box of so many parts, x fastest: the order of chunks in a file.
constexpr Size3 part_at(std::size_t n, const Size3& parts) {
  const auto at = static_cast<std::int64_t>(n);
  return {at % parts.x, at / parts.x % parts.y, at / (parts.x * parts.y)};
}

constexpr Size3 most(const Size3& a, const Size3& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
constexpr Size3 minus(const Size3& a, const Size3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Size3 divided(const Size3& a, const Size3& b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }

/// The samples from `first` up to before `end`.
struct Window {
  Size3 first, end;

  constexpr Size3 size() const { return minus(end, first); }
  constexpr Window common(const Window& other) const { return {most(first, other.first), least(end, other.end)}; }
  friend constexpr bool operator==(const Window&, const Window&) = default;
};

/// The indices of the parts that a window touches.
constexpr Window parts_in(const Window& window, const Size3& part) {
  return {divided(window.first, part), parts_of(window.end, part)};
}

}  // namespace standoff::zarr
