// SPDX-License-Identifier: Apache-2.0
// What `standoff iso` says of the surface it has made.
#pragma once

#include <filesystem>
#include <string>

#include "cli/console.h"
#include "cli/json.h"
#include "standoff/surface.h"

namespace standoff::cli {

/// What the surface was made of.
struct IsoSubject {
  const char* kind = "mesh";  ///< or "field"
  Grid grid;
};

void say(const IsoResult& found, const std::string& output, const Console& console);
Json iso_json(const std::string& input, const IsoSubject& subject, const IsoOptions& options, const IsoResult& found,
              const std::filesystem::path& output);

}  // namespace standoff::cli
