// SPDX-License-Identifier: Apache-2.0
// The method `tiles` on the CPU (docs/tiles.md).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "field/backend.h"
#include "field/cpu/band_choice.h"

namespace standoff::cpu {

Counts run_tiles(const Job& job, Sink& sink);
/// The same by the algorithm given. Bins are for finite thicknesses.
Counts run_tiles_by(BandChoice&& choice, const Job& job, Sink& sink);
/// BackendRow::in_windows.
std::unique_ptr<WindowGather> tiles_in_windows(const Job& job);
/// BackendRow::prepares_whole.
bool tiles_prepare_whole(std::int64_t triangles, const Grid& grid, double thickness);
std::string tiles_device(Simd requested);
std::int64_t tiles_scratch_bytes(const MeshLoad& mesh, const Grid& grid, double thickness, int threads);

}  // namespace standoff::cpu
