// SPDX-License-Identifier: Apache-2.0
// The table of field formats. A format is one file here, which defines its row, and the name of the row in the table.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "files/atomic_file.h"
#include "files/file_view.h"
#include "io/field/write_samples.h"
#include "standoff/field.h"
#include "standoff/io.h"

namespace standoff {

/// What the caller wants of a file.
struct FieldRequest {
  std::int64_t memory_limit = 0;  ///< bytes; 0 is no limit
  bool sidecars = true;
};

class ProgressMeter;
struct FolderFormat;
struct StoredField;

/// A reader throws Error{input} as `FILE:WHERE: what; what to do`, and Error{limit} where field and sidecars would take
/// more than the memory limit, before they take it.
struct FieldFormat {
  const char* extension;
  const char* description;
  bool nearest = false;   ///< can carry nearest triangles
  bool sidecars = false;  ///< can carry sidecars
  bool slabs = false;     ///< can be written slab by slab
  bool sparse = false;    ///< stores whole tiles and tables of them; else a number for each sample
  FieldFile (*read)(const FileView&, const FieldRequest&) = nullptr;
  /// Of a format whose samples can be read from any slice on: x varies fastest, and StoredArray::from() works.
  StoredField (*header)(const FileView&) = nullptr;
  /// Everything but the commit, of a field or, if the format can, of slabs. Sidecars, if the format can carry them,
  /// have been checked.
  void (*write)(AtomicFile&, const FieldSource&, const FieldWriteOptions&) = nullptr;
  /// Of a format of folders, in place of `read` and `write`. The writer commits.
  const FolderFormat* folder = nullptr;
};

/// How fields are read and written whose format is a folder of files.
struct FolderFormat {
  FieldFile (*read)(const std::filesystem::path&, const FieldRequest&, ProgressMeter&);
  void (*write)(const std::filesystem::path&, const FieldSource&, const FieldWriteOptions&, ProgressMeter&);
};

/// The table, in the order of help and messages.
#define STANDOFF_FIELD_FORMATS(ROW) \
  ROW(Vti)                          \
  ROW(Nrrd)                         \
  ROW(Npz)                          \
  ROW(Vdb)                          \
  ROW(Nvdb)                         \
  ROW(Zarr)

#define STANDOFF_ROW(format) extern const FieldFormat kField##format;
STANDOFF_FIELD_FORMATS(STANDOFF_ROW)
#undef STANDOFF_ROW

/// The row of an extension without its dot, in any case of letters; nullptr if there is none.
const FieldFormat* find_field_format(std::string_view extension);

/// FieldFormat::write of a writer that needs the whole field.
template <void (*write)(AtomicFile&, const DistanceField&, const FieldWriteOptions&)>
void of_whole(AtomicFile& file, const FieldSource& source, const FieldWriteOptions& options) {
  write(file, source.whole(), options);
}

}  // namespace standoff
