// SPDX-License-Identifier: Apache-2.0
// The options of a field, which verbs that compute fields share: its grid, sign, method, and where the work runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "cli/json.h"
#include "cli/options.h"
#include "standoff/compute.h"
#include "standoff/field_cache.h"

namespace standoff::cli {

/// The option --cache.
class CacheOption {
 public:
  void add_to(CLI::App& verb, const char* group);
  bool given() const { return !folder_.empty(); }
  /// Makes the folder. Errors: output.
  FieldCache open() const { return FieldCache(folder_); }

 private:
  std::filesystem::path folder_;
};

class FieldOptions {
 public:
  /// All but ComputeOptions::progress and SignOptions::shell, which choose_grid() sets.
  ComputeOptions compute;

  // In this order in the help; the options of the verb's own stand between.
  /// Adds the grid and the thickness.
  void add_grid_to(CLI::App& verb) { grid_.add_to(verb); }
  /// Adds --sign and what goes with it.
  void add_sign_to(CLI::App& verb) { add_sign(verb, compute.sign, shell_); }
  /// Adds --device, -j and --memory-limit.
  void add_work_to(CLI::App& verb);
  /// Adds --method, --skip and the thesis's grids. Call it last.
  void add_thesis_to(CLI::App& verb);

  /// The grid for a mesh with those bounds, and the thickness of its band. Sets the shell's thickness in world units.
  /// Errors: usage; input, for a mesh too far out (`name` stands in the message).
  GridChoice choose_grid(const std::string& name, const Box& box);

  /// What speaks against the thickness; see GridOptions.
  std::string doubt_of_thickness(const Box& mesh) const { return grid_.doubt_of_thickness(mesh); }

  /// The samples of the grid, where no mesh is needed to know them. Errors: usage.
  std::optional<Size3> known_size() const { return grid_.known_size(); }

  /// The memory limit in bytes; the largest number where there is none.
  std::int64_t memory_limit() const;

  /// All that decides the values of a field, whatever was left to a default, for programs that compare. Where the work
  /// runs, and on how many threads, decides none.
  Json parameters() const;

 private:
  GridOptions grid_;
  Thickness shell_{0};  // of --sign shell
};

}  // namespace standoff::cli
