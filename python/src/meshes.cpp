// SPDX-License-Identifier: Apache-2.0
// Meshes and their files.
#include "arrays.h"
#include "lock.h"
#include "standoff/error.h"
#include "standoff/io.h"
#include "standoff/mesh.h"
#include "work.h"

namespace standoff::python {
namespace {

// (vertices, faces, notes, up); the arrays keep the memory that the reader filled.
nb::tuple read_mesh_file(const std::filesystem::path& path, double scale) {
  auto [mesh, report] = watched(nb::none(), [&](const ProgressCallback& progress) {
    return read_mesh(path, {.scale = scale, .progress = progress});
  });
  return nb::make_tuple(array_over<double>(std::move(mesh.vertices)),
                        array_over<std::uint32_t>(std::move(mesh.triangles)), notes(report),
                        std::string(1, name_of(report.up)));
}

void write_mesh_file(const std::filesystem::path& path, const VertexInput& vertices, const FaceInput& faces,
                     bool overwrite) {
  const MeshView mesh = view_of(vertices, faces);
  run_watched(nb::none(), [&](const ProgressCallback& progress) {
    write_mesh(path, mesh, {.existing = overwrite ? Existing::replace : Existing::keep, .progress = progress});
  });
}

// ((x, y, z), (x, y, z)) after a check of the whole mesh.
std::array<std::array<double, 3>, 2> checked_bounds(const VertexInput& vertices, const FaceInput& faces) {
  const MeshView mesh = view_of(vertices, faces);
  const Unlocked released;
  validate(mesh);
  const Box box = bounds(mesh);
  return {{{box.min.x, box.min.y, box.min.z}, {box.max.x, box.max.y, box.max.z}}};
}

std::vector<nb::dict> dicts_of(const std::vector<FileFormat>& formats) {
  std::vector<nb::dict> all;
  for (const FileFormat& f : formats) {
    nb::dict d;
    d["extension"] = f.extension;
    d["description"] = f.description;
    d["readable"] = f.readable;
    d["writable"] = f.writable;
    d["nearest"] = f.nearest;
    d["folder"] = f.folder;
    all.push_back(std::move(d));
  }
  return all;
}

}  // namespace

void add_meshes(nb::module_& m) {
  m.def("read_mesh", &read_mesh_file, "path"_a, "scale"_a);
  m.def("write_mesh", &write_mesh_file, "path"_a, "vertices"_a.noconvert(), "faces"_a.noconvert(), "overwrite"_a);
  m.def("bounds", &checked_bounds, "vertices"_a.noconvert(), "faces"_a.noconvert());
  m.def(
      "content_hash",
      [](const VertexInput& vertices, const FaceInput& faces) { return content_hash(view_of(vertices, faces)); },
      "vertices"_a.noconvert(), "faces"_a.noconvert());
  m.def("mesh_formats", [] { return dicts_of(mesh_formats()); });
  m.def("field_formats", [] { return dicts_of(field_formats()); });
}

}  // namespace standoff::python
