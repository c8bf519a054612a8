// SPDX-License-Identifier: Apache-2.0
// The error that compute() promises of a field (docs/tiles.md): what verify() allows, and what bounds stored in bodies
// are lowered by.
#pragma once

namespace standoff {

/// The most that a sample at `distance` from the mesh is off by, beside the resolution of doubles where the grid is far
/// from the origin; `spacing` is the grid's largest. All in one unit.
constexpr double promised_error(double distance, double spacing) { return 1e-6 * (distance + 16 * spacing); }

}  // namespace standoff
