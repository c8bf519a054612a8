// SPDX-License-Identifier: Apache-2.0
// Thick bands and full fields on the CPU: candidates are handed down from coarse cells to tiles (candidate_culling.h).
#pragma once

#include <cstdint>
#include <memory>

#include "field/backend.h"
#include "field/cpu/kernels.h"

namespace standoff::cpu {

/// Job, lattice and kernels must stay where they are.
std::unique_ptr<LayerGather> thick_band(const Job& job, const BlockLattice& lattice, const Kernels& kernels);

/// Bytes that thick_band may hold, whatever the triangles.
std::int64_t thick_scratch_bytes(std::int64_t triangles, const BlockLattice& lattice, int threads);

}  // namespace standoff::cpu
