// SPDX-License-Identifier: Apache-2.0
// How much memory there is, and how much this process has taken.
#pragma once

#include <cstdint>

namespace standoff::cli {

/// 80 % of the machine's memory, or of the control group's limit where that is smaller.
std::int64_t default_memory_limit();

/// The most memory this process has held at any time.
std::int64_t peak_memory_bytes();

}  // namespace standoff::cli
