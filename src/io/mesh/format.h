// SPDX-License-Identifier: Apache-2.0
// The table of mesh formats. A format is one file here, which defines its row, and the name of the row in the table.
#pragma once

#include <optional>
#include <string_view>

#include "files/atomic_file.h"
#include "files/file_view.h"
#include "standoff/io.h"
#include "standoff/mesh.h"

namespace standoff {

struct MeshFormat {
  const char* extension;
  const char* name;  ///< for messages: "STL"
  const char* description;
  bool (*recognises)(std::string_view content);  ///< cheap; false when in doubt
  /// The file is not empty. What it does to coordinates, it reports.
  Mesh (*read)(const FileView&, MeshReadReport&);
  /// Everything but the commit; nullptr when it cannot.
  void (*write)(AtomicFile&, MeshView, const MeshWriteOptions&) = nullptr;
  bool packed = false;          ///< its files are compressed, so that gzip around them is refused
  std::optional<Axis> up = {};  ///< what points up in what is read, by custom or as it is turned
};

/// The table, in the order of help and messages; the content of a file without a known extension is tried in this
/// order.
#define STANDOFF_MESH_FORMATS(ROW) \
  ROW(Stl)                         \
  ROW(Ply)                         \
  ROW(Obj)                         \
  ROW(Off)                         \
  ROW(Medit)                       \
  ROW(3ds)                         \
  ROW(Glb)                         \
  ROW(Gltf)                        \
  ROW(3mf)                         \
  ROW(Dae)

#define STANDOFF_ROW(format) extern const MeshFormat kMesh##format;
STANDOFF_MESH_FORMATS(STANDOFF_ROW)
#undef STANDOFF_ROW

/// The row of an extension without its dot, in any case of letters; nullptr if there is none.
const MeshFormat* find_mesh_format(std::string_view extension);

/// MeshFormat::read of a reader that takes coordinates as they are.
template <Mesh (*read)(const FileView&)>
Mesh as_is(const FileView& file, MeshReadReport&) {
  return read(file);
}
/// MeshFormat::read of a reader whose format is in metres, and y up.
template <Mesh (*read)(const FileView&)>
Mesh in_metres(const FileView& file, MeshReadReport& report) {
  report.metres_per_unit = 1;
  return read(file);
}

/// MeshFormat::write of a writer of coordinates as they are.
template <void (*write)(AtomicFile&, MeshView)>
void as_they_are(AtomicFile& file, MeshView mesh, const MeshWriteOptions&) {
  write(file, mesh);
}

}  // namespace standoff
