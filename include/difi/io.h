// Reading and writing meshes and fields.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "difi/error.h"
#include "difi/field.h"
#include "difi/mesh.h"

namespace difi {

/// A file format by its file name extension.
struct Format {
  std::string extension;    ///< lower case, without the dot: "stl"
  std::string description;  ///< "STL, binary or ASCII"
  bool readable = false;
  bool writable = false;
  bool nearest = false;  ///< fields only: can carry nearest triangles
};

/// The formats this build knows.
std::vector<Format> mesh_formats();
std::vector<Format> field_formats();

struct MeshReadOptions {
  double scale = 1;  ///< vertices are multiplied by this (finite, positive)
};

/// Reads a mesh; the format goes by the extension, or by content where no format has that extension. A file whose
/// extension says one format and whose content another is an error. Equal vertices are welded exactly, polygons are
/// triangulated. Errors: input, with `FILE:WHERE: what; what to do`; limit when memory runs out.
Mesh read_mesh(const std::filesystem::path& path, const MeshReadOptions& options = {});

/// Writes a mesh; the file appears whole or not at all. Errors: output, usage (unknown extension).
void write_mesh(const std::filesystem::path& path, MeshView mesh);

/// Reads a field written by write_field: the same values, thickness, nearest triangles and provenance. Errors: input;
/// limit when memory runs out.
DistanceField read_field(const std::filesystem::path& path);

/// Writes a field as .vti, .nrrd or .npz (docs/formats.md); the file appears whole or not at all. Values are never held
/// densely. Errors: output, usage (unknown extension, or nearest triangles in a format that cannot carry them).
void write_field(const std::filesystem::path& path, const DistanceField& field);

}  // namespace difi
