// SPDX-License-Identifier: Apache-2.0
// Parallel loops for files that nvcc compiles, which do not include TBB.
#pragma once

#include <functional>

namespace standoff {

/// Calls work(0), ..., work(count - 1), on at most `threads` threads (0: as many as the caller may use). The first
/// exception is thrown again.
void side_by_side(int threads, int count, const std::function<void(int)>& work);

}  // namespace standoff
