#include "difi/mesh.h"

namespace difi {

Box bounds(MeshView mesh) {
  Box box;
  for (const auto& triangle : mesh.triangles)
    for (const auto v : triangle) box.include(mesh.vertices[v]);
  return box;
}

}  // namespace difi
