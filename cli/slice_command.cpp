// difi slice: a picture of a plane of a field.
#include "cli/commands.h"

namespace difi::cli {
void add_slice(CLI::App&) {}
}  // namespace difi::cli
