// SPDX-License-Identifier: Apache-2.0
// What `standoff compute` says of what it will do, does and has done.
#pragma once

#include <optional>
#include <string>

#include "cli/console.h"
#include "cli/grid_options.h"
#include "standoff/compute.h"
#include "standoff/confidence.h"
#include "standoff/mesh.h"

namespace standoff::cli {

/// A computation before it starts.
struct Plan {
  std::string mesh_name;
  const Mesh& mesh;
  GridChoice choice;
  std::string output;
  bool in_the_way = false;  ///< the output exists, and may not be overwritten
  double load_seconds = 0;
  bool in_slabs = false;  ///< the field is written while it is computed
};

/// "grid 256 x 254 x 200, spacing 0.1, full field".
std::string grid_line(const GridChoice& choice);

/// What --dry-run prints. Throws Error{limit} after it where the real run would be refused for its memory.
void tell(const Plan& plan, const ComputeOptions& options, const Console& console);

/// A computation that has written its field.
struct Outcome {
  Plan plan;
  ComputeReport report;
  std::uint64_t mesh_hash = 0;
  double write_seconds = 0;
  std::int64_t written_bytes = 0;
  std::optional<SignConfidence> confidence = {};
};

void say(const Outcome& outcome, const Console& console);
Json outcome_json(const Outcome& outcome);

}  // namespace standoff::cli
