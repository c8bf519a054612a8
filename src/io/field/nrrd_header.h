// SPDX-License-Identifier: Apache-2.0
// The text header of a NRRD file. https://teem.sourceforge.net/nrrd/format.html
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "files/file_view.h"

namespace standoff {

struct NrrdLine {
  std::string text;
  int number = 0;
};

struct NrrdHeader {
  const FileView& file;
  std::map<std::string, NrrdLine> fields;  ///< "name: value", names in lower case and without blanks
  std::map<std::string, NrrdLine> keys;    ///< "key:=value", escapes undone
  std::uint64_t data = 0;                  ///< offset of the first sample

  /// Throws Error{input} that names the line.
  [[noreturn]] void fail(const NrrdLine& line, const std::string& what) const;
  /// The field of that name, which is the same with blanks and without ("axis mins"), or nullptr.
  const NrrdLine* find(const std::string& name) const;
  /// The field of that name, or an error.
  const NrrdLine& get(const std::string& name) const;
  /// The key of that name, or nullptr.
  const NrrdLine* key(const std::string& name) const;
};

/// Reads the lines up to the empty one. Errors: input.
NrrdHeader read_nrrd_header(const FileView& file);

/// The value of a key as the header spells it.
std::string nrrd_escaped(const std::string& value);

}  // namespace standoff
