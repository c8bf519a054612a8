// SPDX-License-Identifier: Apache-2.0
// Work on all blocks, by many threads.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <iterator>
#include <utility>

#include "core/progress.h"
#include "surface/blocks.h"
#include "surface/neighbourhood.h"

namespace standoff {

/// Calls use(number, block, corners, values) for each block. Runs on the threads of the calling TBB arena. Throws
/// Error{interrupted}.
template <class Use>
void for_each_block(const Blocks& blocks, const UniformTiles& uniform, ProgressMeter& progress, const Use& use) {
  constexpr std::size_t kAtOnce = 16;  // some tens of microseconds
  const auto all = blocks.all();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, all.size(), kAtOnce), [&](const auto& range) {
    progress.advance(static_cast<std::int64_t>(range.size()));
    for (std::size_t n = range.begin(); n < range.end(); ++n)
      use(n, all[n], blocks.corner_bits(all[n]), Neighbourhood(blocks.field(), uniform, all[n].at));
  });
}

}  // namespace standoff
