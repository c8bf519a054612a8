// SPDX-License-Identifier: Apache-2.0
// Colors.
#pragma once

#include <array>
#include <cstdint>

namespace standoff {

/// sRGB: red, green and blue, 8 bits each.
using Color = std::array<std::uint8_t, 3>;

/// Colors that tell several bodies apart in pictures and pages, after the first, which is grey.
inline constexpr std::array<Color, 7> kBodyColors{{{226, 160, 84},
                                                   {106, 153, 208},
                                                   {112, 178, 128},
                                                   {205, 122, 148},
                                                   {150, 134, 200},
                                                   {92, 178, 182},
                                                   {190, 172, 120}}};

}  // namespace standoff
