// SPDX-License-Identifier: Apache-2.0
// Fields that were computed before, in a folder that many programs may share (docs/batch.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "standoff/compute.h"
#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/vec.h"

namespace standoff {

/// A folder of field files by what they were made of: ab/ab0123456789abcd.npz, and beside it a .json with all that it
/// was made of, the hash of its bytes, and the report of the computation. Files get their names when they are complete,
/// and programs that make the same field write the same bytes: any number of them may write at a time, on several
/// machines too. An entry that is damaged, or is of something else with the same hash, counts as missing and is
/// replaced. Nothing is ever removed. The folder of the option --cache is the same.
class STANDOFF_API FieldCache {
 public:
  /// Makes the folder. Errors: output.
  explicit FieldCache(const std::filesystem::path& folder);

  /// A field, and whether it was computed before.
  struct Computed {
    DistanceField field;
    ComputeReport report;  ///< of the computation, also where it was an earlier one; its seconds are 0 then
    bool cached = false;
    /// What was wrong with the entry, or with keeping the field; empty if nothing was. The field is good in any case.
    std::string problem;
  };
  /// Does what compute() does, unless the folder has the field; and keeps it there as .npz. Nearest triangles are not
  /// kept. Errors: as compute(); usage, for options.nearest and options.decision.
  Computed compute(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options = {}) const;

  // For files of one's own.

  /// How a field is written, which decides its bytes too.
  struct File {
    /// Samples of a grid, from the first on.
    struct Window {
      Size3 first, size;
    };
    std::string extension = "npz";  ///< without its dot
    bool compress = true;
    std::optional<Window> window = {};  ///< the file has these of the grid's samples alone
  };
  /// Everything that decides the bytes of a field's file. Devices, threads and limits do not. Errors of key(): usage,
  /// for options.nearest and options.decision.
  struct Key {
    std::string text;
    std::string extension;
  };
  static Key key(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options, const File& file);

  struct Fetched {
    std::optional<ComputeReport> report;  ///< nothing: there is no such entry
    std::string problem;                  ///< of one that is damaged
  };
  /// Puts the file of an entry at `target`, as a hard link where the file system can. Errors: output (the target).
  Fetched fetch(const Key& key, const std::filesystem::path& target, Existing existing) const;
  /// Keeps a file that was made. What goes wrong is returned as a sentence, since the file itself is there.
  std::string store(const Key& key, const std::filesystem::path& made, const ComputeReport& report) const;

 private:
  std::filesystem::path entry_of(const Key& key) const;
  Fetched look_up(const Key& key) const;

  std::filesystem::path folder_;
};

}  // namespace standoff
