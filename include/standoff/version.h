#pragma once

#define STANDOFF_VERSION "0.1.0"

namespace standoff {
/// The version of the library, e.g. "0.1.0".
const char* version();
}  // namespace standoff
