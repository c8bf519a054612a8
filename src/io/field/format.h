// The table of field formats: a format is one file and a row in field_formats.cpp.
#pragma once

#include "files/atomic_file.h"
#include "io/field/input.h"
#include "standoff/field.h"

namespace standoff {

struct FieldFormat {
  const char* extension;
  const char* description;
  bool nearest;  ///< can carry nearest triangles
  DistanceField (*read)(const FieldInput&);
  void (*write)(AtomicFile&, const DistanceField&);  ///< everything but the commit
};

DistanceField read_vti(const FieldInput& file);
void write_vti(AtomicFile& file, const DistanceField& field);

DistanceField read_nrrd(const FieldInput& file);
void write_nrrd(AtomicFile& file, const DistanceField& field);

DistanceField read_npz(const FieldInput& file);
void write_npz(AtomicFile& file, const DistanceField& field);

}  // namespace standoff
