// SPDX-License-Identifier: Apache-2.0
// Thin bands on the CPU: triangles are sorted into the bricks that they reach (bins.h).
#pragma once

#include <cstdint>
#include <memory>

#include "field/backend.h"
#include "field/cpu/kernels.h"

namespace standoff::cpu {

/// Job, lattice and kernels must stay where they are.
std::unique_ptr<LayerGather> thin_band(const Job& job, const BlockLattice& lattice, const Kernels& kernels);

/// Bytes that thin_band may hold, whatever the triangles.
std::int64_t thin_scratch_bytes(std::int64_t triangles, const BlockLattice& lattice, int threads);

}  // namespace standoff::cpu
