// SPDX-License-Identifier: Apache-2.0
// Surfaces of fields and meshes.
#include "standoff/surface.h"

#include "arrays.h"
#include "options.h"
#include "work.h"

namespace standoff::python {
namespace {

SurfaceOptions options_of(double at, double wall, const std::string& method, int threads) {
  constexpr const char* kMethods[] = {"marching_cubes", "dual"};
  return {.at = at,
          .wall = wall,
          .method = static_cast<SurfaceMethod>(choice_of("method", method, kMethods)),
          .execution = {.threads = threads}};
}

// (vertices, faces, sign, what is lost)
nb::tuple arrays_of(SurfaceResult&& result) {
  return nb::make_tuple(array_over<double>(std::move(result.mesh.vertices)),
                        array_over<std::uint32_t>(std::move(result.mesh.triangles)), sign_dict(result.report.sign),
                        result.report.lost);
}

nb::tuple of_field(const DistanceField& field, double at, double wall, const std::string& method, int threads,
                   const nb::object& progress) {
  SurfaceOptions options = options_of(at, wall, method, threads);
  return arrays_of(watched(progress, [&](const ProgressCallback& report) {
    options.progress = report;
    return surface(field, options);
  }));
}

nb::tuple of_mesh(const VertexInput& vertices, const FaceInput& faces, const GridInput& grid, const nb::handle& sign,
                  double at, double wall, const std::string& method, int threads, const nb::object& progress) {
  const MeshView mesh = view_of(vertices, faces);
  SurfaceOptions options = options_of(at, wall, method, threads);
  options.sign = sign_of(sign);
  return arrays_of(watched(progress, [&](const ProgressCallback& report) {
    options.progress = report;
    return surface(mesh, grid.grid(), options);
  }));
}

}  // namespace

void add_surfaces(nb::module_& m) {
  m.def("surface_of_field", &of_field, "field"_a, "at"_a, "wall"_a, "method"_a, "threads"_a, "progress"_a.none());
  m.def("surface_of_mesh", &of_mesh, "vertices"_a.noconvert(), "faces"_a.noconvert(), "grid"_a, "sign"_a, "at"_a,
        "wall"_a, "method"_a, "threads"_a, "progress"_a.none());
}

}  // namespace standoff::python
