// SPDX-License-Identifier: Apache-2.0
// The leaves of a tree on their way into a file: made on all cores, written in order.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "core/threads.h"
#include "files/atomic_file.h"
#include "io/field/vdb_tree.h"

namespace standoff::vdb {

/// Calls make(n, to) for each leaf, which writes at most `most` bytes there and returns how many they are. Some are
/// made while others are written.
template <class Make>
void write_leaves(AtomicFile& file, const Tree& tree, int threads, std::size_t most, const Make& make) {
  constexpr std::size_t kAtOnce = 512;  // two megabytes in all, which stay in the cache
  const std::size_t all = tree.leaves.size();
  struct Part {
    std::vector<char> bytes;
    std::vector<std::size_t> lengths;
    std::size_t first = 0, count = 0;
  };
  std::array<Part, 2> parts;
  for (Part& part : parts) {
    part.bytes.resize(most * std::min(kAtOnce, all));
    part.lengths.resize(std::min(kAtOnce, all));
  }
  const auto fill = [&](Part& part, std::size_t first) {
    part.first = std::min(first, all);
    part.count = std::min(kAtOnce, all - part.first);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part.count, 16), [&](const auto& range) {
      for (std::size_t n = range.begin(); n < range.end(); ++n)
        part.lengths[n] = make(part.first + n, part.bytes.data() + most * n);
    });
  };
  const auto write = [&](const Part& part) {
    for (std::size_t n = 0; n < part.count;) {
      const std::size_t first = n;
      std::size_t bytes = part.lengths[n++];
      // At once those without gaps between them.
      while (n < part.count && bytes == most * (n - first)) bytes += part.lengths[n++];
      file.write(part.bytes.data() + most * first, bytes);
    }
  };
  Threads(threads).run([&] {
    fill(parts[0], 0);
    for (std::size_t n = 0; parts[n].count > 0; n = 1 - n)
      tbb::parallel_invoke([&] { write(parts[n]); }, [&] { fill(parts[1 - n], parts[n].first + kAtOnce); });
  });
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
