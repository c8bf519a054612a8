// SPDX-License-Identifier: Apache-2.0
// The error of too little device memory.
#pragma once

#include <cstdint>
#include <string>

#include "standoff/error.h"

namespace standoff::gpu {

/// Throws Error{limit}: `need` bytes were wanted, `free` of `total` were there. More may be wanted later, when the
/// lists have been counted.
[[noreturn]] inline void throw_out_of_memory(std::int64_t need, std::int64_t free, std::int64_t total) {
  const auto mib = [](std::int64_t bytes) { return std::to_string((bytes + (1 << 20) - 1) >> 20); };
  throw Error(ErrorCode::limit,
              "cuda: this field needs at least " + mib(need) + " MiB more of the GPU's memory, " +
                  std::to_string(free >> 20) + " of " + mib(total) +
                  " MiB are free; take fewer samples or a smaller thickness, or use the CPU",
              {.bytes_needed = need, .bytes_limit = free});
}

}  // namespace standoff::gpu
