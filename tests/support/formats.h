// SPDX-License-Identifier: Apache-2.0
// The readers of single formats, by the extension.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

#include "io/field/format.h"
#include "io/mesh/format.h"
#include "tests/support/paths.h"

namespace standoff {

inline Mesh read_as(std::string_view extension, const FileView& file) {
  MeshReadReport report;
  return find_mesh_format(extension)->read(file, report);
}

inline FieldFile read_as(std::string_view extension, const FileView& file, const FieldRequest& request) {
  return find_field_format(extension)->read(file, request);
}

/// The first column of the first table after the words `after` in docs/formats.md: a line for each row.
inline std::string documented(std::string_view after) {
  std::stringstream page;
  page << std::ifstream(std::string(kSourceFolder) + "/docs/formats.md").rdbuf();
  std::string names;
  bool found = false;
  for (std::string line; std::getline(page, line);) {
    found = found || line.starts_with(after);
    if (!found || !line.starts_with('|')) {
      if (!names.empty()) break;
      continue;
    }
    names += line.substr(1, line.find('|', 1) - 1) + "\n";
  }
  return names;
}

}  // namespace standoff
