// SPDX-License-Identifier: Apache-2.0
#include "field/copies.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "core/hashes.h"
#include "core/progress.h"
#include "geometry/predicates.h"

namespace standoff {
namespace {

using CornerBits = std::array<std::uint64_t, 9>;

// CornerBits and not values are compared: 0 equals -0, but may give a result that does not.
CornerBits corner_bits_of(MeshView mesh, std::uint32_t triangle) {
  return std::bit_cast<CornerBits>(Corners(mesh.corners(triangle)));
}

std::uint64_t corner_hash(const CornerBits& bits) {
  std::uint64_t h = 0;
  for (const std::uint64_t word : bits) {
    h = (h ^ word) * kSplitmixStep;
    h ^= h >> 32;
  }
  return h;
}

std::size_t number_among(MeshView mesh, std::span<const std::uint32_t> among) {
  return among.empty() ? mesh.triangles.size() : among.size();
}
std::uint32_t nth_among(std::span<const std::uint32_t> among, std::size_t n) {
  return among.empty() ? static_cast<std::uint32_t>(n) : among[n];
}

// Triangles by their corners: a table of places, with linear probing.
class CornerTable {
 public:
  CornerTable(MeshView mesh, std::size_t most) : mesh_(mesh), places_(most + most / 4 + 1, kNoTriangle) {}

  /// Returns whether a triangle with the same corners was added before.
  bool add(std::uint32_t triangle) {
    // Triangles of one hash could be many by design: past so many, the rest counts as new.
    constexpr int kMostCompared = 64;
    const CornerBits bits = corner_bits_of(mesh_, triangle);
    std::size_t place = static_cast<std::size_t>((corner_hash(bits) >> 32) * places_.size() >> 32);
    for (int n = 0; n < kMostCompared; ++n) {
      if (places_[place] == kNoTriangle) {
        places_[place] = triangle;
        return false;
      }
      if (corner_bits_of(mesh_, places_[place]) == bits) return true;
      if (++place == places_.size()) place = 0;
    }
    return false;
  }

 private:
  MeshView mesh_;
  std::vector<std::uint32_t> places_;
};

}  // namespace

// Of k triangles taken at random, about k^2 / 2n (m - 1) pairs are copies, if a triangle has m - 1 others on average:
// with k = 8 sqrt(n), that is 32 (m - 1). A triangle that was taken twice is no copy.
bool has_many_copies(MeshView mesh, std::span<const std::uint32_t> among) {
  const std::size_t all = number_among(mesh, among);
  const auto taken = std::min(all, static_cast<std::size_t>(8 * std::sqrt(static_cast<double>(all))));
  std::vector<std::uint32_t> some(taken);
  for (std::size_t n = 0; n < taken; ++n)
    some[n] = nth_among(among, taken == all ? n : static_cast<std::size_t>(splitmix64(n) % all));
  std::ranges::sort(some);
  some.erase(std::unique(some.begin(), some.end()), some.end());
  std::vector<std::uint64_t> hashes;
  for (const std::uint32_t triangle : some) hashes.push_back(corner_hash(corner_bits_of(mesh, triangle)));
  std::ranges::sort(hashes);
  double pairs = 0;
  for (auto next = hashes.begin(); next != hashes.end();) {
    const auto first = next;
    next = std::find_if(next, hashes.end(), [&](std::uint64_t h) { return h != *first; });
    const auto same = static_cast<double>(next - first);
    pairs += same * (same - 1) / 2;
  }
  const auto k = static_cast<double>(some.size());
  return pairs > 0 && 8 * pairs * static_cast<double>(all) >= k * k;  // m - 1 >= 1/4
}

std::vector<std::uint32_t> without_many_copies(MeshView mesh, std::span<const std::uint32_t> among,
                                               ProgressMeter& progress) {
  if (!has_many_copies(mesh, among)) return {};
  const std::size_t all = number_among(mesh, among);
  std::vector<bool> is_copy(all);
  std::size_t copies = 0;
  {
    CornerTable table(mesh, all);
    WorkCheck check(progress, 1 << 16);
    for (std::size_t n = 0; n < all; ++n) {
      is_copy[n] = table.add(nth_among(among, n));
      copies += is_copy[n];
      check.add(1);
    }
  }
  std::vector<std::uint32_t> kept;
  if (copies == 0) return kept;
  kept.reserve(all - copies);
  for (std::size_t n = 0; n < all; ++n)
    if (!is_copy[n]) kept.push_back(nth_among(among, n));
  return kept;
}

}  // namespace standoff
