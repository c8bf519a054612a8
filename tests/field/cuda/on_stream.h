// SPDX-License-Identifier: Apache-2.0
// For tests of standoff/cuda_compute.h, emulated: meshes in other layouts, and the CPU's fields to compare with.
#pragma once

#include <cstdint>
#include <vector>

#include "standoff/compute.h"
#include "standoff/cuda_compute.h"
#include "standoff/testing/emulation.h"

namespace standoff {

/// The emulated device's memory is plain memory.
inline const cuda::OnStream kEmulated{.backend = testing::kEmulated};

/// The mesh in rows with a gap behind each, as other programs may lay it out.
template <class Number, class Index>
struct Strided {
  explicit Strided(const Mesh& mesh) {
    for (const Vec3& v : mesh.vertices)
      for (const double x : {v.x, v.y, v.z, 1e30}) numbers.push_back(static_cast<Number>(x));
    for (const Triangle& t : mesh.triangles) {
      for (const std::uint32_t index : t) indices.push_back(static_cast<Index>(index));
      indices.insert(indices.end(), 2, static_cast<Index>(-7));
    }
  }
  MeshView view() const {
    return {{numbers.data(), numbers.size() / 4, 4 * sizeof(Number)},
            {indices.data(), indices.size() / 5, 5 * sizeof(Index)}};
  }
  std::vector<Number> numbers;
  std::vector<Index> indices;
};

/// A task whose mesh is where it is; without output.
inline cuda::Task emulated_task(const Mesh& mesh, const Grid& grid, double thickness, const SignOptions& sign) {
  cuda::Task task;
  task.mesh = {&mesh.vertices.data()->x, static_cast<std::int64_t>(mesh.vertices.size()), mesh.triangles.data()->data(),
               static_cast<std::int64_t>(mesh.triangles.size())};
  task.grid = grid;
  task.thickness = thickness;
  task.sign = sign;
  return task;
}

/// The CPU's field without a sign and a skip rule, as on a device.
inline std::vector<float> on_cpu(const MeshView& mesh, const Grid& grid, double thickness,
                                 Method method = Method::tiles) {
  std::vector<float> values(static_cast<std::size_t>(grid.sample_count()));
  ComputeOptions options{.sign = {SignMethod::none}};
  options.method = method;
  options.skip.kind = SkipRule::Kind::none;
  options.execution.backend = Backend::cpu;
  compute_into(mesh, grid, thickness, values, options);
  return values;
}

/// Triangles across grids of about 20 samples, half a unit apart: they are near the tiles on both sides, and so in
/// three times as many lists as the estimate expects.
inline Mesh wide_triangles() {
  Mesh mesh;
  for (std::uint32_t n = 0; n < 300; ++n) {
    const double z = 1 + 0.001 * n;
    mesh.vertices.insert(mesh.vertices.end(), {{-40, -40, z}, {60, -40, z}, {-40, 60, z}});
    mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  return mesh;
}

}  // namespace standoff
