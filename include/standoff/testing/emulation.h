// SPDX-License-Identifier: Apache-2.0
// Runs the GPU's kernels on the CPU, thread by thread, to find faults (docs/cuda.md). It is slow; use it only for
// tests.
#pragma once

#include "standoff/execution.h"

namespace standoff::testing {

/// A backend that is accepted wherever Backend::cuda is. Its answers are those of a GPU. The value is far from those of
/// the enumerators, which may become more.
inline constexpr Backend kEmulated{1000};
static_assert(find_info(kEmulated)->backend == kEmulated);

}  // namespace standoff::testing
