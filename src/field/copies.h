// SPDX-License-Identifier: Apache-2.0
// Meshes with very many copies of triangles: scenes that place a part again and again where it is. All copies are
// equally near, so every sample would look at every one of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "standoff/mesh.h"

namespace standoff {

/// Whether a triangle taken at random has other copies, at least about a quarter of one on average. A copy has the same
/// corners one by one, bit by bit. Looks at some 8 sqrt(n) of n triangles, so it costs next to nothing; the answer for
/// a mesh is always the same. `among`: ascending numbers of triangles; all if it is empty. Requires a valid mesh.
bool has_many_copies(MeshView mesh, std::span<const std::uint32_t> among = {});

/// If has_many_copies(): the triangles without the copies of ones before them, ascending, but for a few copies where
/// many triangles have one hash. They have the same distances, and of equally near triangles the same lowest number.
/// Empty if all of `among` stay. Takes 5.125 bytes per triangle at the most, for a table or for the result, which is
/// less than any work on them does. Throws Error{interrupted}.
std::vector<std::uint32_t> without_many_copies(MeshView mesh, std::span<const std::uint32_t> among,
                                               ProgressMeter& progress);

}  // namespace standoff
