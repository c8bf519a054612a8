// SPDX-License-Identifier: Apache-2.0
#include "standoff/mesh.h"

#include "core/guarded.h"
#include "core/mesh_errors.h"

namespace standoff {

Box bounds(MeshView mesh) try {
  Box box;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle triangle = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      if (triangle[k] >= mesh.vertices.size()) fail_index(mesh, t, k);
      box.include(mesh.vertices[triangle[k]]);
    }
  }
  return box;
} catch (...) {
  throw_as_error("mesh");
}

}  // namespace standoff
