// SPDX-License-Identifier: Apache-2.0
// Validates Execution.
#pragma once

#include "standoff/execution.h"

namespace standoff {

/// Which backends a call has.
enum class Runs { everywhere, on_the_cpu };

/// Throws Error{usage}, beginning with `where`, for invalid values, and for a backend the call does not
/// have.
void validate(const char* where, const Execution& execution, Runs runs);

}  // namespace standoff
