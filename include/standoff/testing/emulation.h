// SPDX-License-Identifier: Apache-2.0
// Runs the GPU's kernels on the CPU, thread by thread, to find faults (docs/cuda.md). It is slow; use it only for
// tests.
#pragma once

#include "standoff/execution.h"

namespace standoff::testing {

/// A backend that is accepted wherever Backend::cuda is. Its answers are those of a GPU.
inline constexpr Backend kEmulated{3};

}  // namespace standoff::testing
