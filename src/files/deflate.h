// SPDX-License-Identifier: Apache-2.0
// Packs bytes of any kind, by zlib (RFC 1950). Samples with long runs are packed faster by run_deflate.h.
#pragma once

#include <string>
#include <string_view>

namespace standoff {

/// The bytes as a zlib stream. `level`: 0 (stored) to 9 (smallest), as zlib has them.
std::string zlib_packed(std::string_view bytes, int level);

}  // namespace standoff
