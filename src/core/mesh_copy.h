// SPDX-License-Identifier: Apache-2.0
// Copies a view of a mesh.
#pragma once

#include "standoff/mesh.h"

namespace standoff {

/// A packed copy of a valid mesh in any layout.
inline Mesh copy_of(const MeshView& mesh) {
  const auto all = [](const auto& array, auto& to) {
    if (const auto packed = array.as_span()) {
      to.assign(packed->begin(), packed->end());
      return;
    }
    to.reserve(array.size());
    for (const auto& one : array) to.push_back(one);
  };
  Mesh copy;
  all(mesh.vertices, copy.vertices);
  all(mesh.triangles, copy.triangles);
  return copy;
}

}  // namespace standoff
