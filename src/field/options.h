// What the options of a computation mean where they leave something open.
#pragma once

#include "standoff/compute.h"

namespace standoff {

/// Throws Error{usage} for options that make no sense.
void validate(const ComputeOptions& options);
/// The skip rule of the method where none is named; never automatic.
SkipRule effective_rule(const ComputeOptions& options);

}  // namespace standoff
