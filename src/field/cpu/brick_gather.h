// SPDX-License-Identifier: Apache-2.0
// What thin and thick bands share: triangles as the kernels take them, and the end of a brick.
#pragma once

#include <cstdint>
#include <span>

#include "field/backend.h"
#include "field/cpu/kernels.h"

namespace standoff::cpu {

/// The triangles of the job's mesh with these indices. Requires `refs` to live as long.
Candidates candidates_of(const Job& job, std::span<const std::uint32_t> refs);

/// Writes the tiles of a finished brick that hold band samples, and counts these. Forgets its samples past the grid.
void write_brick(const BlockLattice& lattice, const Brick& brick, const Kernels& kernels, BrickState& state,
                 Sink& sink);

}  // namespace standoff::cpu
