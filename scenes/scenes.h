// SPDX-License-Identifier: Apache-2.0
// Meshes made by code: the same on every machine, any size on request. Shared by the program, tests and bench.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "standoff/mesh.h"

namespace standoff::scenes {

struct Scene {
  std::string name;            ///< "factory"
  std::string description;     ///< one line, for people
  std::int64_t triangles = 0;  ///< when no number is asked for
};

// The assemblies (all but the simple shapes) stand on y = 0, with y up, centred on the y axis. Their parts are closed
/// and face outwards, but for the exhaust stubs of the plane and the chute of our_process; parts overlap as they do in
/// CAD.

/// The most triangles that make() makes: about 10 GB, and vertex indices stay far below 2^32.
inline constexpr std::int64_t kMostTriangles = 200'000'000;

/// All scenes, in the order of the documentation.
std::vector<Scene> all();

/// Makes a scene. `triangles` = 0 takes the scene's own count; otherwise the mesh has as near to that many triangles as
/// its construction allows. Errors: usage for an unknown name (the message lists the known ones) or a count out of
/// range.
Mesh make(std::string_view name, std::int64_t triangles = 0);

}  // namespace standoff::scenes
