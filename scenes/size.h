// SPDX-License-Identifier: Apache-2.0
// Brings a scene to a wanted number of triangles.
#pragma once

#include <cstdint>

#include "scenes/builder.h"

namespace standoff::scenes {

using Draw = void (*)(Builder&);

/// The target edge at which `draw` makes as many triangles as it can without passing `triangles`, or nearly (within
/// half a percent); the search starts from `guess`. Where even the coarsest version is larger, the edge of that one.
double edge_for(Draw draw, std::int64_t triangles, double guess, double slender);

/// Splits the longest edges at their midpoints until the mesh has `triangles`. Both triangles of a shared edge are
/// split, so what was closed stays closed; a mesh without boundary edges therefore ends one short of an odd number.
/// A mesh that is large enough already is left alone.
void split_to(Mesh& mesh, std::int64_t triangles);

}  // namespace standoff::scenes
