// SPDX-License-Identifier: Apache-2.0
// The options that say how inside is decided, for every verb that asks.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/json.h"
#include "cli/parse.h"
#include "standoff/sign.h"

namespace standoff::cli {

/// What the help says.
struct SignHelp {
  const char* sign;
  const char* outer;
};

/// Adds --sign, with all methods, and what goes with it. The thickness of --sign shell goes to `shell`: it may be in
/// samples. The default is what `options` hold.
void add_sign(CLI::App& verb, SignOptions& options, Thickness& shell, const SignHelp& help);
/// With the help of verbs that answer with distances, for a default of none.
void add_sign(CLI::App& verb, SignOptions& options, Thickness& shell);

/// Adds --sign, --rule, --invert, --as-oriented and --strict for verbs that ask about samples or triangles and not for
/// distances. `methods`: what --sign takes, of auto, winding, parity, normal, flood and none.
void add_sign_to(CLI::App& verb, const std::vector<std::string>& methods, const char* help, SignOptions& options);

/// Whether any of these options stands on the command line of a verb, with whatever value.
bool is_sign_given(const CLI::App& verb);
/// Whether any of them was given another value than it has without.
bool is_given(const SignOptions& options);

/// Adds how the sign was decided to an answer: `sign.method`, `sign.why` and `sign.sure`.
void add_sign_report(Json& json, const SignReport& report);

}  // namespace standoff::cli
