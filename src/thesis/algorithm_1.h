// SPDX-License-Identifier: Apache-2.0
// The method `thesis` on the CPU: Algorithm 1 of the 2008 thesis (docs/thesis.md).
#pragma once

#include <cstdint>
#include <string>

#include "field/backend.h"

namespace standoff::cpu {

/// For each triangle, for each sample in its box grown by the thickness: the squared distance, kept where it is
/// smaller. Counts::samples_examined is the number of these pairs. Skipping and compaction come before (Job::kept).
Counts run_thesis(const Job& job, Sink& sink);
std::string thesis_device(Simd requested);
std::int64_t thesis_scratch_bytes(std::int64_t triangles, const Grid& grid, double thickness, int threads);

}  // namespace standoff::cpu
