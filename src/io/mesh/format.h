// SPDX-License-Identifier: Apache-2.0
// The table of mesh formats: a format is one file and a row in formats.cpp.
#pragma once

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
  void (*write)(AtomicFile&, MeshView);  ///< everything but the commit; nullptr when it cannot
};

bool is_stl(std::string_view content);
Mesh read_stl(const FileView& file);
void write_stl(AtomicFile& file, MeshView mesh);

bool is_ply(std::string_view content);
Mesh read_ply(const FileView& file);
void write_ply(AtomicFile& file, MeshView mesh);

bool is_obj(std::string_view content);
Mesh read_obj(const FileView& file);
void write_obj(AtomicFile& file, MeshView mesh);

bool is_off(std::string_view content);
Mesh read_off(const FileView& file);

bool is_medit(std::string_view content);
Mesh read_medit(const FileView& file);

Mesh read_gltf(const FileView& file);
Mesh read_glb(const FileView& file);

bool is_3mf(std::string_view content);
Mesh read_3mf(const FileView& file, MeshReadReport& report);

bool is_3ds(std::string_view content);
Mesh read_3ds(const FileView& file, MeshReadReport& report);

bool is_dae(std::string_view content);
Mesh read_dae(const FileView& file, MeshReadReport& report);

}  // namespace standoff
