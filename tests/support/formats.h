// SPDX-License-Identifier: Apache-2.0
// The readers of single formats, by the extension.
#pragma once

#include <string_view>

#include "io/field/format.h"
#include "io/mesh/format.h"

namespace standoff {

inline Mesh read_as(std::string_view extension, const FileView& file) {
  MeshReadReport report;
  return find_mesh_format(extension)->read(file, report);
}

inline FieldFile read_as(std::string_view extension, const FileView& file, const FieldRequest& request) {
  return find_field_format(extension)->read(file, request);
}

}  // namespace standoff
