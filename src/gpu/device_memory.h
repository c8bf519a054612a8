// SPDX-License-Identifier: Apache-2.0
// The error of too little device memory.
#pragma once

#include <cstdint>
#include <string>

#include "standoff/error.h"

namespace standoff::gpu {

/// The work does not fit into the GPU's memory. A feature that knows how its work gets smaller catches it and says so.
class OutOfMemory : public Error {
 public:
  using Error::Error;
};

/// Throws OutOfMemory, an Error{limit}: `need` bytes were wanted, `free` of `total` were there. More may be wanted
/// later, when the work is better known.
[[noreturn]] inline void throw_out_of_memory(std::int64_t need, std::int64_t free, std::int64_t total) {
  const auto mib = [](std::int64_t bytes) { return std::to_string((bytes + (1 << 20) - 1) >> 20); };
  throw OutOfMemory(ErrorCode::limit,
                    "cuda: the work needs at least " + mib(need) + " MiB more of the GPU's memory, " +
                        std::to_string(free >> 20) + " of " + mib(total) + " MiB are free; use the CPU",
                    {.bytes_needed = need, .bytes_limit = free});
}

}  // namespace standoff::gpu
