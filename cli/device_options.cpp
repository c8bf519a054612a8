#include "cli/device_options.h"

#include "cli/option.h"
#include "cli/parse.h"

namespace difi::cli {

using S = const std::string&;

CLI::Option* add_device(CLI::App& verb, const char* group, Backend& backend, int& device) {
  return add_parsed(verb,
                    {"--device", "NAME", "auto (default), cpu, cuda, cuda:N or emulated; see difi\ndevices", group},
                    [&](S o, S t) { backend = parse_backend(o, t, device); });
}

CLI::Option* add_threads(CLI::App& verb, const char* group, int& threads) {
  return add_parsed(verb, {"-j,--threads", "N", "threads (default: all)", group},
                    [&](S o, S t) { threads = static_cast<int>(parse_count(o, t, 1, 4096)); });
}

}  // namespace difi::cli
