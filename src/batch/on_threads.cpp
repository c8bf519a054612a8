// SPDX-License-Identifier: Apache-2.0
#include "batch/on_threads.h"

#include "core/threads.h"

namespace standoff {

void on_threads(int threads, const std::function<void()>& work) { Threads(threads).run(work); }

}  // namespace standoff
