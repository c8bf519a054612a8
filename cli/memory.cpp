// SPDX-License-Identifier: Apache-2.0
#include "cli/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace standoff::cli {

std::int64_t default_memory_limit() {
  constexpr double kShare = 0.8;
  double bytes = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGE_SIZE));
  // A container's limit, for control groups of version 2 and 1. No limit reads as "max" or as a huge number.
  for (const char* file : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"})
    if (double limit = 0; std::ifstream(file) >> limit && limit > 0) bytes = std::min(bytes, limit);
  return static_cast<std::int64_t>(bytes * kShare);
}

std::int64_t peak_memory_bytes() {
  struct rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace standoff::cli
