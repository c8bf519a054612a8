// SPDX-License-Identifier: Apache-2.0
// The GPU's kernels on the CPU, thread by thread: slow, for finding faults (docs/cuda.md). Not for products.
#pragma once

#include "standoff/execution.h"

namespace standoff::testing {

/// A backend like any other, wherever Backend::cuda is one. The answers are a GPU's.
inline constexpr Backend kEmulated{3};

}  // namespace standoff::testing
