// SPDX-License-Identifier: Apache-2.0
// What the options of a computation mean where they leave something open.
#pragma once

#include "standoff/compute.h"

namespace standoff {

/// Throws Error{usage} for an invalid thickness or invalid options.
void validate(double thickness, const ComputeOptions& options);
/// The skip rule of the method where none is named; never automatic.
SkipRule effective_rule(const ComputeOptions& options);

}  // namespace standoff
