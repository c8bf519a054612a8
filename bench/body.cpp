// SPDX-License-Identifier: Apache-2.0
// Makes the bodies of collision queries.
#include <algorithm>

#include "collision_workload.h"
#include "conforming.h"
#include "scenes/scenes.h"
#include "scenes/size.h"
#include "standoff/io.h"

namespace standoff::bench {

Mesh make_body(const BodySource& source) {
  const bool conforming = is_conforming(source.name);
  const bool file = !conforming && source.name.find('/') != std::string::npos;
  Mesh mesh = conforming ? make_conforming(source.name, source.triangles)
              : file     ? read_mesh(source.name).mesh
                         : scenes::make(source.name, source.triangles);
  if (file) scenes::split_to(mesh, source.triangles);
  if (source.size > 0) {
    const Box box = bounds(mesh);
    const Vec3 extent = box.extent();
    const double scale = source.size / std::max({extent.x, extent.y, extent.z});
    for (Vec3& v : mesh.vertices) v = (v - box.center()) * scale;
  }
  return mesh;
}

}  // namespace standoff::bench
