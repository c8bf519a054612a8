// SPDX-License-Identifier: Apache-2.0
// A stream of work on a GPU, for code that does not see CUDA's headers.
#pragma once

struct CUstream_st;

namespace standoff::cuda {

/// A cudaStream_t, as in standoff/cuda.h, which has it for its callers.
using Stream = CUstream_st*;

}  // namespace standoff::cuda
