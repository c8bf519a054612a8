// SPDX-License-Identifier: Apache-2.0
// Checks how a sign is asked for.
#pragma once

#include "standoff/sign.h"

namespace standoff {

/// Throws Error{usage} where options are invalid, or exclude each other.
void validate(const SignOptions& options);

}  // namespace standoff
