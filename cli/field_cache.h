// SPDX-License-Identifier: Apache-2.0
// Fields that were computed before, in a folder that many programs may share.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "cli/field_options.h"
#include "cli/json.h"
#include "standoff/compute.h"
#include "standoff/existing.h"
#include "standoff/mesh.h"

namespace standoff::cli {

/// A folder of field files by what they were made of: ab/ab0123456789abcd.npz, and beside it a .json with all that it
/// was made of, its hash, and the report of the computation. Files get their names when they are complete, and programs
/// that make the same field write the same bytes: any number of them may write at a time. An entry that is damaged, or
/// is of something else with the same hash, counts as missing and is replaced.
class FieldCache {
 public:
  /// Adds --cache.
  void add_to(CLI::App& verb, const char* group);
  bool given() const { return !folder_.empty(); }
  /// Makes the folder. Errors: output.
  void open() const;

  /// Everything that decides the bytes of a field's file. `file`: the format, and what stands beside the distances.
  static Json key(MeshView mesh, const FieldOptions& options, const GridChoice& choice, const Json& file);

  /// Puts the file of an entry at `target`, as a hard link where the file system can, and returns the report of its
  /// computation; nothing where there is no such entry. Errors: output (the target).
  std::optional<ComputeReport> fetch(const Json& key, const std::filesystem::path& target, Existing existing) const;
  /// Keeps a file that was made. What goes wrong is returned as a sentence, since the file itself is there.
  std::string store(const Json& key, const std::filesystem::path& made, const ComputeReport& report) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace standoff::cli
