// SPDX-License-Identifier: Apache-2.0
// Reading and writing meshes and fields.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "standoff/error.h"
#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/mesh.h"
#include "standoff/progress.h"
#include "standoff/sidecars.h"

namespace standoff {

class FieldSlabs;

/// A file format. Its file name extension identifies it.
struct FileFormat {
  std::string extension;    ///< lower case, without the dot: "stl"
  std::string description;  ///< "STL, binary or ASCII"
  bool readable = false;
  bool writable = false;
  bool nearest = false;   ///< fields only: can carry nearest triangles
  bool sidecars = false;  ///< fields only: can carry sidecars
  bool slabs = false;     ///< fields only: can be written slab by slab
  bool sparse =
      false;  ///< fields only: stores whole tiles and tables of them, so that a sample may take more than 4 bytes
  bool folder = false;  ///< fields only: a folder of files, not a file
};

/// The formats that this build can read or write.
STANDOFF_API std::vector<FileFormat> mesh_formats();
STANDOFF_API std::vector<FileFormat> field_formats();

struct MeshReadOptions {
  double scale = 1;  ///< vertices are multiplied by this (finite, positive)
  ProgressCallback progress = {};
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
  /// The axis of the coordinates as read that points up in pictures: y of OBJ, z of STL, by custom; y of formats that
  /// name an axis, which are turned to it; of others up_axis() of the mesh.
  Axis up = Axis::z;

  bool turned() const { return axes != std::array<int, 3>{1, 2, 3}; }
};

struct MeshReadResult {
  Mesh mesh;
  MeshReadReport report;
};

/// The report as English sentences without full stops. Empty if the reader changed nothing and the unit is unknown.
/// Errors: usage (an axis that is not 1, 2 or 3, or negative).
STANDOFF_API std::vector<std::string> notes(const MeshReadReport& report);

/// Reads a mesh. The extension decides the format; if no format has that extension, the content decides. It is an error
/// if extension and content contradict each other. A file may be compressed by gzip: mesh.obj.gz is read as OBJ. Equal
/// vertices are welded exactly, and polygons are triangulated. Errors: input, with a message `FILE:WHERE: what; what to
/// do`; limit (memory); interrupted.
STANDOFF_API MeshReadResult read_mesh(const std::filesystem::path& path, const MeshReadOptions& options = {});

struct MeshWriteOptions {
  Existing existing = Existing::replace;
  ProgressCallback progress = {};
  // Of the formats that are written, GLB and 3MF have a unit and a direction that is up (docs/formats_meshes.md).
  /// Metres per unit of the coordinates, as MeshReadReport has it; 0: unknown, which GLB takes for metres and 3MF for
  /// millimetres.
  double metres_per_unit = 0;
  /// The axis that points up, as MeshReadReport has it: the mesh is turned so that the format's does, y of GLB and z of
  /// 3MF. Nothing: it is not turned.
  std::optional<Axis> up = {};
};

/// Writes a mesh; the file appears whole or not at all. Errors: output (also a mesh that the format cannot hold),
/// usage (unknown extension, a number of metres that is negative or not finite), interrupted.
STANDOFF_API void write_mesh(const std::filesystem::path& path, MeshView mesh, const MeshWriteOptions& options = {});
inline void write_mesh(const std::filesystem::path& path, MeshView mesh, Existing existing) {
  write_mesh(path, mesh, MeshWriteOptions{.existing = existing});
}

struct FieldReadOptions {
  /// Bytes that the field may take, checked before allocation. 0: default_memory_limit(); negative: no limit.
  std::int64_t memory_limit = 0;
  ProgressCallback progress = {};
};

/// Reads a field written by write_field: the same values, thickness, nearest triangles and provenance. Errors: input;
/// limit (memory_limit, or memory runs out); interrupted.
STANDOFF_API DistanceField read_field(const std::filesystem::path& path, const FieldReadOptions& options = {});

/// A field, and the arrays beside it.
struct FieldFile {
  DistanceField field;
  std::vector<Sidecar> sidecars;  ///< in the file's order, for the slots of `field`
};

/// Reads a field with its sidecars: every array of floats or bytes with a number, or a few, for each sample. In tiles
/// that are not stored their numbers are lost: write_field writes zeros there. Errors: as read_field; the memory limit
/// holds for field and sidecars together.
STANDOFF_API FieldFile read_field_file(const std::filesystem::path& path, const FieldReadOptions& options = {});

struct FieldWriteOptions {
  Existing existing = Existing::replace;
  /// Whether samples are compressed (docs/formats.md). Compressed files take longer to read; runs of equal samples,
  /// which most of a band's grid is, take nearly no room.
  bool compress = true;
  /// Arrays to write beside the distances, each with the numbers of every stored tile of the field.
  std::span<const Sidecar> sidecars = {};
  int threads = 0;  ///< that compress; 0: as many as the machine has. The file has the same bytes for any number
  /// Whether to wait until the bytes are on the disk, so that a loss of power does not take the file away. Takes
  /// milliseconds; false, where many files are written and missing ones are made again.
  bool sync = true;
  /// Zarr stores only: how many levels they have, each of every second sample of the one before (standoff/zarr.h).
  int levels = 1;
  ProgressCallback progress = {};
};

/// Writes a field in the format of the extension (docs/formats.md); the file appears whole or not at all. The whole
/// field is never converted to dense values in memory. Errors: output; usage (unknown extension, nearest triangles or
/// sidecars in a format that cannot carry them, sidecars that do not fit the field or share a name), interrupted.
STANDOFF_API void write_field(const std::filesystem::path& path, const DistanceField& field,
                              const FieldWriteOptions& options = {});
inline void write_field(const std::filesystem::path& path, const DistanceField& field, Existing existing) {
  write_field(path, field, FieldWriteOptions{.existing = existing});
}

/// Writes a field that comes slab by slab (standoff/slabs.h): the same file, byte by byte, as of the whole field. The
/// slabs are used up. Memory: one slab, and a few MiB for each thread. Formats: those with FileFormat::slabs. Errors:
/// as above; usage also for another format, for slabs with nearest triangles, for sidecars, and for slabs that do not
/// make up the grid; what next() throws.
STANDOFF_API void write_field(const std::filesystem::path& path, FieldSlabs& slabs,
                              const FieldWriteOptions& options = {});

}  // namespace standoff
