// SPDX-License-Identifier: Apache-2.0
// The table of field formats: a format is one file and a row in formats.cpp.
#pragma once

#include <cstdint>

#include "files/atomic_file.h"
#include "files/file_view.h"
#include "io/field/field_source.h"
#include "standoff/field.h"
#include "standoff/io.h"

namespace standoff {

/// What of a file is asked for.
struct FieldRequest {
  std::int64_t memory_limit = 0;  ///< bytes; 0 is no limit
  bool sidecars = true;
};

/// A reader throws Error{input} as `FILE:WHERE: what; what to do`, and Error{limit} where field and sidecars would take
/// more than the memory limit, before they take it.
struct FieldFormat {
  const char* extension;
  const char* description;
  bool nearest;   ///< can carry nearest triangles
  bool sidecars;  ///< can carry sidecars
  bool slabs;     ///< can be written of slabs
  FieldFile (*read)(const FileView&, const FieldRequest&);
  /// Everything but the commit, of a field or, if the format can, of slabs. Sidecars, if the format can carry them,
  /// have been checked.
  void (*write)(AtomicFile&, const FieldSource&, const FieldWriteOptions&);
};

FieldFile read_vti(const FileView& file, const FieldRequest& request);
void write_vti(AtomicFile& file, const FieldSource& field, const FieldWriteOptions& options);

FieldFile read_nrrd(const FileView& file, const FieldRequest& request);
void write_nrrd(AtomicFile& file, const FieldSource& field, const FieldWriteOptions& options);

FieldFile read_npz(const FileView& file, const FieldRequest& request);
void write_npz(AtomicFile& file, const FieldSource& field, const FieldWriteOptions& options);

FieldFile read_nvdb(const FileView& file, const FieldRequest& request);
void write_nvdb(AtomicFile& file, const DistanceField& field, const FieldWriteOptions& options);

FieldFile read_vdb(const FileView& file, const FieldRequest& request);
void write_vdb(AtomicFile& file, const DistanceField& field, const FieldWriteOptions& options);

}  // namespace standoff
