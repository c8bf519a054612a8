// SPDX-License-Identifier: Apache-2.0
// Gives the values of an unsigned field their sign.
#pragma once

#include <span>

#include "core/progress.h"
#include "sign/each_row_of_tiles.h"
#include "standoff/field.h"

namespace standoff {

/// Negates the values inside. A tile that is not stored becomes an inside one, or is stored if it has samples on both
/// sides. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
void sign_field(Sides& sides, bool invert, DistanceField& field, ProgressMeter& progress);
/// The same for the next layers of tiles of `rows`: those of `slab`, whose first one is layer `first_layer` of the grid
/// that the rows are those of. Runs on the threads of their TBB arena.
void sign_slab(RowsOfTiles& rows, std::int64_t first_layer, DistanceField& slab);
/// The same for one value per sample, x fastest.
void sign_values(Sides& sides, bool invert, const Grid& grid, std::span<float> values, ProgressMeter& progress);

}  // namespace standoff
