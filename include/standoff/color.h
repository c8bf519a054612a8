// SPDX-License-Identifier: Apache-2.0
// Colors.
#pragma once

#include <array>
#include <cstdint>

namespace standoff {

/// sRGB: red, green and blue, 8 bits each.
using Color = std::array<std::uint8_t, 3>;

}  // namespace standoff
