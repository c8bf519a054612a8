// SPDX-License-Identifier: Apache-2.0
// A piece of work that is held to a number of threads, whatever it calls.
#pragma once

#include <functional>

namespace standoff {

/// Runs `work` so that all it calls together takes no more than `threads` threads, 1 or more, also functions that take
/// no number: reading, hashing. What it throws passes.
void on_threads(int threads, const std::function<void()>& work);

}  // namespace standoff
