// SPDX-License-Identifier: Apache-2.0
// The table of field formats: a format is one file and a row in formats.cpp.
#pragma once

#include <cstdint>

#include "files/atomic_file.h"
#include "files/file_view.h"
#include "standoff/field.h"

namespace standoff {

/// A reader throws Error{input} as `FILE:WHERE: what; what to do`, and Error{limit} where the field would take more
/// than `memory_limit` bytes, before it takes them; 0 is no limit.
struct FieldFormat {
  const char* extension;
  const char* description;
  bool nearest;  ///< can carry nearest triangles
  DistanceField (*read)(const FileView&, std::int64_t memory_limit);
  void (*write)(AtomicFile&, const DistanceField&);  ///< everything but the commit
};

DistanceField read_vti(const FileView& file, std::int64_t memory_limit);
void write_vti(AtomicFile& file, const DistanceField& field);

DistanceField read_nrrd(const FileView& file, std::int64_t memory_limit);
void write_nrrd(AtomicFile& file, const DistanceField& field);

DistanceField read_npz(const FileView& file, std::int64_t memory_limit);
void write_npz(AtomicFile& file, const DistanceField& field);

}  // namespace standoff
