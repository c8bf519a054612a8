// SPDX-License-Identifier: Apache-2.0
// The options that say how inside is decided, for every verb that asks.
#pragma once

#include <CLI/CLI.hpp>

#include "cli/json.h"
#include "cli/parse.h"
#include "standoff/sign.h"

namespace standoff::cli {

/// Adds --sign and what goes with it. The thickness of --sign shell goes to `shell`: it may be in samples.
void add_sign(CLI::App& verb, SignOptions& options, Thickness& shell);

/// Whether any of them was given another value than it has without.
bool is_given(const SignOptions& options);

/// Adds how the sign was decided to an answer: `sign.method`, `sign.why` and `sign.sure`.
void add_sign_report(Json& json, const SignReport& report);

}  // namespace standoff::cli
