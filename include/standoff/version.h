// SPDX-License-Identifier: Apache-2.0
// The version of standoff.
#pragma once

#define STANDOFF_VERSION_MAJOR 0
#define STANDOFF_VERSION_MINOR 1
#define STANDOFF_VERSION_PATCH 0
#define STANDOFF_VERSION "0.1.0"

#include "standoff/export.h"

namespace standoff {
/// The version of the library, such as "0.1.0": the version of the headers with which it was compiled.
STANDOFF_API const char* version();
}  // namespace standoff
