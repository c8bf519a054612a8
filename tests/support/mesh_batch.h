// SPDX-License-Identifier: Apache-2.0
// Many meshes one behind the other in host memory, as standoff/cuda_batch.h takes them from a device's.
#pragma once

#include <cstdint>
#include <vector>

#include "standoff/cuda_batch.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff::testing {

struct MeshBatch {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::int64_t> first_vertex{0}, first_triangle{0};
  std::vector<cuda::BatchPlace> places;

  void add(const Mesh& mesh, const cuda::BatchPlace& place) {
    vertices.insert(vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    triangles.insert(triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
    first_vertex.push_back(static_cast<std::int64_t>(vertices.size()));
    first_triangle.push_back(static_cast<std::int64_t>(triangles.size()));
    places.push_back(place);
  }
  std::int64_t count() const { return static_cast<std::int64_t>(places.size()); }
  /// The grid of a mesh, if the fields have this size.
  Grid grid(std::size_t n, const Size3& size) const { return {size, places[n].origin, places[n].spacing}; }
  /// A task with the sizes alone.
  cuda::BatchTask sizes(const Size3& size) const {
    cuda::BatchTask task;
    task.count = count();
    task.vertex_count = first_vertex.back();
    task.triangle_count = first_triangle.back();
    task.size = size;
    return task;
  }
};

}  // namespace standoff::testing
