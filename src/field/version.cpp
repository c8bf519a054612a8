#include "difi/version.h"

namespace difi {
const char* version() { return DIFI_VERSION; }
}  // namespace difi
