// SPDX-License-Identifier: Apache-2.0
// The middle of a parallel counting sort.
#pragma once

#include <cstddef>
#include <utility>

namespace standoff {

/// `counts` holds, for each part of the input, how many of its items belong to each of `keys` keys. Each count becomes
/// the place of its first item in the sorted output: by key, then by part. Calls begins(key, place) for each key in
/// order, and returns the number of items.
template <class Parts, class Begins>
auto places_from_counts(Parts& counts, std::size_t keys, const Begins& begins) {
  auto total = typename Parts::value_type::value_type{0};
  for (std::size_t key = 0; key < keys; ++key) {
    begins(key, total);
    for (auto& count : counts) total += std::exchange(count[key], total);
  }
  return total;
}

}  // namespace standoff
