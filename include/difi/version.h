#pragma once

#define DIFI_VERSION "0.1.0"

namespace difi {
/// The version of the library, e.g. "0.1.0".
const char* version();
}  // namespace difi
