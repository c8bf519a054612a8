// SPDX-License-Identifier: Apache-2.0
// Which triangles of a closed mesh are on the surface of its solid (docs/outer.md).
#pragma once

#include <cstdint>
#include <vector>

#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/mesh.h"
#include "standoff/progress.h"
#include "standoff/sign.h"

namespace standoff {

enum class Exposure : std::uint8_t {
  exposed,   ///< outside is on one of its sides, or on both
  internal,  ///< inside is on both sides, all over
  cut,       ///< others are in its interior, and it may be both; or it is so thin that rounding hides what it is
};

struct ExposedTriangles {
  std::vector<Exposure> of;  ///< for each triangle
  std::int64_t internal = 0, cut = 0;
  SignReport sign;  ///< how inside was decided
};

struct ExposedOptions {
  SignOptions sign = {};     ///< winding or automatic; the rule says what is inside
  Execution execution = {};  ///< the backend must be automatic or cpu
  ProgressCallback progress = {};
};

/// Runs on the CPU. The result does not depend on the
/// number of threads. Takes some 200 bytes per triangle. Errors: those of validate(mesh); input (the mesh is not closed
/// after orientation), doubt (`strict`), usage (`sign`, execution), interrupted.
STANDOFF_API ExposedTriangles exposed_triangles(MeshView mesh, const ExposedOptions& options = {});

}  // namespace standoff
