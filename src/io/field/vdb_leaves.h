// SPDX-License-Identifier: Apache-2.0
// The leaves of a tree on their way into a file: made on all cores, written in order.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/threads.h"
#include "files/atomic_file.h"
#include "io/field/vdb_tree.h"

namespace standoff::vdb {

/// Calls make(n, to) for each leaf, which writes at most `most` bytes there and returns how many they are.
template <class Make>
void write_leaves(AtomicFile& file, const Tree& tree, int threads, std::size_t most, const Make& make) {
  constexpr std::size_t kAtOnce = 1024;
  const std::size_t all = tree.leaves.size();
  std::vector<char> bytes(most * std::min(kAtOnce, all));
  std::vector<std::size_t> lengths(std::min(kAtOnce, all));
  Threads arena(threads);
  for (std::size_t first = 0; first < all; first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, all - first);
    arena.run([&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16), [&](const auto& range) {
        for (std::size_t n = range.begin(); n < range.end(); ++n) lengths[n] = make(first + n, bytes.data() + most * n);
      });
    });
    for (std::size_t n = 0; n < count; ++n) file.write(bytes.data() + most * n, lengths[n]);
  }
}

/// Calls use(n) for each leaf, on all threads.
template <class Use>
void each_leaf(const Tree& tree, int threads, const Use& use) {
  Threads(threads).run([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tree.leaves.size(), 64), [&](const auto& range) {
      for (std::size_t n = range.begin(); n < range.end(); ++n) use(n);
    });
  });
}

}  // namespace standoff::vdb
