// SPDX-License-Identifier: Apache-2.0
// A field that a verb reads.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "cli/console.h"
#include "standoff/field.h"
#include "standoff/io.h"

namespace standoff::cli {

class FieldArgument {
 public:
  /// Adds --memory-limit, for `what`.
  void add_to(CLI::App& verb, const std::string& what = "the field that is read");
  /// What was given, or the default.
  std::int64_t memory_limit() const;
  /// Terminals are shown what is waited for. Errors: input; limit, before any memory is taken.
  DistanceField read(const std::string& name, const Console& console) const;
  /// With its sidecars.
  FieldFile read_file(const std::string& name, const Console& console) const;
  /// Throws Error{usage} where the option was given: `name` is no field.
  void check_unused(const std::string& name) const;

 private:
  FieldReadOptions options_for(const std::string& name) const;

  std::optional<std::int64_t> memory_limit_;
};

}  // namespace standoff::cli
