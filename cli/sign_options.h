// SPDX-License-Identifier: Apache-2.0
// The options that say what is inside, for verbs that ask about samples or triangles and not for distances.
#pragma once

#include <CLI/CLI.hpp>

#include "standoff/sign.h"

namespace standoff::cli {

/// Adds --sign, --rule, --invert, --as-oriented and --strict, in the group Sign. `methods`: what --sign takes, of
/// auto, winding, parity, normal, flood and none.
void add_sign_to(CLI::App& verb, const std::vector<std::string>& methods, const char* help, SignOptions& sign);

}  // namespace standoff::cli
