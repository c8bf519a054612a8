// SPDX-License-Identifier: Apache-2.0
// Fields on a GPU as the table of backends sees them (src/backends/fields.cpp): on CUDA, and emulated on the CPU.
#pragma once

#include "field/backend.h"

namespace standoff::cuda {
Counts run_tiles(const Job& job, Sink& sink);
Counts run_thesis(const Job& job, Sink& sink);
/// Bytes of host memory beside the output; the GPU's own memory is not counted.
std::int64_t scratch_bytes(std::int64_t triangles, const Grid& grid, double thickness, int threads);
}  // namespace standoff::cuda

namespace standoff::emulated {
Counts run_tiles(const Job& job, Sink& sink);
Counts run_thesis(const Job& job, Sink& sink);
/// The same, and the memory that stands for the GPU's.
std::int64_t scratch_bytes(std::int64_t triangles, const Grid& grid, double thickness, int threads);
}  // namespace standoff::emulated
