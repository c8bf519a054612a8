// SPDX-License-Identifier: Apache-2.0
// Thick bands and full fields on the CPU: candidates are handed down from coarse cells to tiles (candidate_culling.h).
#pragma once

#include <cstdint>

#include "field/backend.h"
#include "field/cpu/kernels.h"

namespace standoff::cpu {

Counts gather_thick(const Job& job, const BlockLattice& lattice, const Kernels& kernels, Sink& sink);

/// Bytes that gather_thick may hold, whatever the triangles.
std::int64_t thick_scratch_bytes(std::int64_t triangles, const BlockLattice& lattice, int threads);

}  // namespace standoff::cpu
