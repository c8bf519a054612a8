// SPDX-License-Identifier: Apache-2.0
// Disjoint sets (union-find) with parity: each member is flipped relative to its set's representative, or is not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace standoff {

/// The representative of a set is its least member, so that nothing depends on the order in which sets were joined.
/// Both operations take amortised logarithmic time (halved paths), and constant time in practice.
class DisjointSets {
 public:
  struct Place {
    std::uint32_t set;  ///< the representative
    bool flipped;       ///< relative to it
  };

  explicit DisjointSets(std::size_t count) : link_(count) {
    for (std::size_t n = 0; n < count; ++n) link_[n] = std::uint64_t{n} << 1;
  }

  std::size_t size() const { return link_.size(); }

  Place find(std::uint32_t n) {
    bool flipped = false;
    for (;;) {
      const std::uint64_t up = link_[n];
      const auto parent = static_cast<std::uint32_t>(up >> 1);
      if (parent == n) return {n, flipped};
      const std::uint64_t above = link_[parent];
      link_[n] = above ^ (up & 1);  // past the parent, with both parities
      flipped ^= ((above ^ up) & 1) != 0;
      n = static_cast<std::uint32_t>(above >> 1);
    }
  }

  /// Joins two sets so that b is flipped relative to a, or is not. Returns false and changes nothing if a and b are in
  /// one set already that contradicts this.
  bool join(std::uint32_t a, std::uint32_t b, bool flipped = false) {
    Place low = find(a), high = find(b);
    const bool relative = low.flipped ^ high.flipped ^ flipped;
    if (low.set == high.set) return !relative;
    if (low.set > high.set) std::swap(low, high);
    link_[high.set] = std::uint64_t{low.set} << 1 | std::uint64_t{relative};
    return true;
  }

 private:
  std::vector<std::uint64_t> link_;  // the parent, and in the lowest bit the parity relative to it
};

}  // namespace standoff
