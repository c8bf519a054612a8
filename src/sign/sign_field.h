// SPDX-License-Identifier: Apache-2.0
// Gives the values of an unsigned field their sign.
#pragma once

#include <span>

#include "core/progress.h"
#include "sign/sides.h"
#include "standoff/field.h"

namespace standoff {

/// Negates the values inside. A tile that is not stored becomes an inside one, or is stored if it has samples on both
/// sides. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
void sign_field(Sides& sides, bool invert, DistanceField& field, ProgressMeter& progress);
/// The same for one value per sample, x fastest.
void sign_values(Sides& sides, bool invert, const Grid& grid, std::span<float> values, ProgressMeter& progress);

}  // namespace standoff
