// SPDX-License-Identifier: Apache-2.0
// What info says about a mesh.
#pragma once

#include <cstddef>
#include <string>

#include "cli/json.h"
#include "standoff/mesh_report.h"

namespace standoff::cli {

/// A line of an answer for people: a name and a value.
std::string row(const char* name, const std::string& value);

/// The report for people, one screen. `vertices` counts those of the file.
std::string report_text(const MeshReport& report, std::size_t vertices);
/// Adds the report to an answer: the keys that docs/json.md lists.
void add_report(Json& json, const MeshReport& report);

}  // namespace standoff::cli
