// SPDX-License-Identifier: Apache-2.0
// Reading and writing meshes and fields.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "standoff/error.h"
#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/mesh.h"

namespace standoff {

/// A file format. Its file name extension identifies it.
struct FileFormat {
  std::string extension;    ///< lower case, without the dot: "stl"
  std::string description;  ///< "STL, binary or ASCII"
  bool readable = false;
  bool writable = false;
  bool nearest = false;  ///< fields only: can carry nearest triangles
};

/// The formats that this build can read or write.
STANDOFF_API std::vector<FileFormat> mesh_formats();
STANDOFF_API std::vector<FileFormat> field_formats();

struct MeshReadOptions {
  double scale = 1;  ///< vertices are multiplied by this (finite, positive)
};

/// What a file says about its coordinates, and how the reader changed them, apart from MeshReadOptions::scale. The
/// coordinates of STL, PLY, OBJ, OFF and .mesh files are not changed.
struct MeshReadReport {
  std::string format;     ///< the extension of the format, such as "3ds"
  bool unpacked = false;  ///< the file was compressed by gzip
  double unit_scale = 1;  ///< coordinates were multiplied by this because of the file's unit
  /// Metres per unit of the coordinates as read, before the caller's scale; 0: the file does not say.
  double metres_per_unit = 0;
  /// Which axes of the file became x, y and z: 1, 2, 3 for its x, y, z; negative if the direction was reversed.
  std::array<int, 3> axes{1, 2, 3};

  bool turned() const { return axes != std::array<int, 3>{1, 2, 3}; }
};

/// The report as English sentences without full stops. Empty if the reader changed nothing and the unit is unknown.
/// Errors: usage (an axis that is not 1, 2 or 3, or negative).
STANDOFF_API std::vector<std::string> notes(const MeshReadReport& report);

/// Reads a mesh. The extension decides the format; if no format has that extension, the content decides. It is an error
/// if extension and content contradict each other. A file may be compressed by gzip: mesh.obj.gz is read as OBJ. Equal
/// vertices are welded exactly, and polygons are triangulated. `report`, unless null, receives what was done to the
/// coordinates. Errors: input, with a message `FILE:WHERE: what; what to do`; limit (memory).
STANDOFF_API Mesh read_mesh(const std::filesystem::path& path, const MeshReadOptions& options = {},
                            MeshReadReport* report = nullptr);

/// Writes a mesh; the file appears whole or not at all. Errors: output, usage (unknown extension).
STANDOFF_API void write_mesh(const std::filesystem::path& path, MeshView mesh, Existing existing = Existing::replace);

struct FieldReadOptions {
  std::int64_t memory_limit = 0;  ///< bytes that the field may take; 0: no limit. Checked before allocation
};

/// Reads a field written by write_field: the same values, thickness, nearest triangles and provenance. Errors: input;
/// limit (memory_limit, or memory runs out).
STANDOFF_API DistanceField read_field(const std::filesystem::path& path, const FieldReadOptions& options = {});

/// Writes a field as .vti, .nrrd or .npz (docs/formats.md); the file appears whole or not at all. The whole field is
/// never converted to dense values in memory. Errors: output, usage (unknown extension, or nearest triangles in a
/// format that cannot carry them).
STANDOFF_API void write_field(const std::filesystem::path& path, const DistanceField& field,
                              Existing existing = Existing::replace);

}  // namespace standoff
