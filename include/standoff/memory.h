// SPDX-License-Identifier: Apache-2.0
// How much memory a call may take (docs/defaults.md).
#pragma once

#include <cstdint>

#include "standoff/export.h"

namespace standoff {

/// A memory limit that is none. Every negative limit says the same.
inline constexpr std::int64_t kNoMemoryLimit = -1;

/// The limit that a call has where its options name none (0): 80 % of the machine's memory, or of what the process's
/// control group allows where that is less, bytes. Asked of the system once. kNoMemoryLimit where it does not say.
STANDOFF_API std::int64_t default_memory_limit();

}  // namespace standoff
