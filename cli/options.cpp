// SPDX-License-Identifier: Apache-2.0
#include "cli/options.h"

#include <algorithm>
#include <cstdint>
#include <thread>

#include "cli/parse.h"

namespace standoff::cli {

CLI::Option* add_device(CLI::App& verb, const char* group, Backend& backend, int& device) {
  return add_parsed(verb,
                    {"--device", "NAME", "auto (default), cpu, cuda, cuda:N or emulated; see standoff\ndevices", group},
                    [&](S o, S t) { backend = parse_backend(o, t, device); });
}

void add_uncompressed(CLI::App& verb, bool& uncompressed) {
  verb.add_flag("--uncompressed", uncompressed,
                "write the samples of .vti, .nrrd and .npz as they are: larger\nfiles that are read faster")
      ->group("Output");
}

namespace {

// TBB never starts more than this, and warns on stderr when it is asked to.
std::int64_t most_threads() { return std::clamp(4 * std::thread::hardware_concurrency(), 256u, unsigned{kMaxThreads}); }

}  // namespace

CLI::Option* add_threads(CLI::App& verb, const char* group, int& threads) {
  return add_parsed(verb, {"-j,--threads", "N", "threads (default: all)", group},
                    [&](S o, S t) { threads = static_cast<int>(parse_count(o, t, 1, most_threads())); });
}

}  // namespace standoff::cli
