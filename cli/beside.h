// SPDX-License-Identifier: Apache-2.0
// What `standoff compute --with` stores beside distances.
#pragma once

#include <string>
#include <vector>

#include "cli/files.h"
#include "standoff/compute.h"
#include "standoff/io.h"
#include "standoff/sidecars.h"

namespace standoff::cli {

class Beside {
 public:
  /// Takes names with commas between them. Errors: usage.
  void add(const std::string& option, const std::string& text);
  bool empty() const { return !nearest_ && kinds_.empty(); }
  /// Throws Error{usage} where the output's format has no place for them.
  void check(const FileOutput& output) const;
  /// Asks for what they are made of, and for the memory they take.
  void prepare(ComputeOptions& options) const;
  /// Makes them, and takes nearest triangles out of the field unless they are to be stored.
  std::vector<Sidecar> make(MeshView mesh, DistanceField& field, const Execution& execution,
                            const ProgressCallback& progress) const;

 private:
  bool nearest_ = false;
  std::vector<SidecarKind> kinds_;
};

/// Of the sidecars that are made as `compute --with` makes them: in how many samples they are not what the mesh and the
/// stored nearest triangles give. 0 where there are none, or no nearest triangles.
std::int64_t count_wrong(const FieldFile& file, MeshView mesh, const Execution& execution);

}  // namespace standoff::cli
