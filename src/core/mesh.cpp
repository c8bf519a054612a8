#include "standoff/mesh.h"

#include <string>

#include "core/guarded.h"
#include "standoff/error.h"

namespace standoff {

Box bounds(MeshView mesh) try {
  Box box;
  for (const auto& triangle : mesh.triangles)
    for (const auto v : triangle) {
      if (v >= mesh.vertices.size())
        throw Error(ErrorCode::input, "mesh: index " + std::to_string(v) + " is out of range, there are " +
                                          std::to_string(mesh.vertices.size()) + " vertices; repair the mesh");
      box.include(mesh.vertices[v]);
    }
  return box;
} catch (...) {
  throw_as_error("mesh");
}

}  // namespace standoff
