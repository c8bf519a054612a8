// SPDX-License-Identifier: Apache-2.0
#include "standoff/version.h"

namespace standoff {
const char* version() { return STANDOFF_VERSION; }
}  // namespace standoff
