// SPDX-License-Identifier: Apache-2.0
// Which axis points up in pictures and pages.
#pragma once

#include <optional>
#include <vector>

#include "standoff/mesh.h"

namespace standoff {

/// The first that is known; else up_axis() of the first mesh; else z. Errors: input (an index out of range).
inline Axis first_up(const std::vector<std::optional<Axis>>& known, const MeshView* first_mesh) {
  for (const std::optional<Axis>& up : known)
    if (up) return *up;
  return first_mesh ? up_axis(*first_mesh) : Axis::z;
}

}  // namespace standoff
