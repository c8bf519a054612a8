// SPDX-License-Identifier: Apache-2.0
// Algorithms of others, for comparison (docs/methods.md): the functions in the tables of src/backends. None is exact,
// and none is a default.
#pragma once

#include <cstdint>

#include "field/backend.h"

namespace standoff::cpu {

/// Fuhrmann 2003 (fuhrmann.cpp). Requires a finite thickness.
Counts run_fuhrmann(const Job& job, Sink& sink);

/// Vector propagation (propagate.h) and jump flooding (jumpflood.h). They hold a number for each sample of the grid, or
/// two, and throw the error of throw_no_seeds().
Counts run_propagate(const Job& job, Sink& sink);
Counts run_jumpflood(const Job& job, Sink& sink);
Counts run_jumpflood_1(const Job& job, Sink& sink);
std::int64_t spread_scratch_bytes(const MeshLoad& mesh, const Grid& grid, double thickness, int threads);

}  // namespace standoff::cpu
