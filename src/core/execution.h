// SPDX-License-Identifier: Apache-2.0
// The check of what callers say about where to run.
#pragma once

#include "standoff/execution.h"

namespace standoff {

/// Which backends a call has.
enum class Runs { everywhere, on_the_cpu };

/// Throws Error{usage}, beginning with `where`, for invalid values, and for a backend the call does not
/// have.
void validate(const char* where, const Execution& execution, Runs runs);

}  // namespace standoff
