// SPDX-License-Identifier: Apache-2.0
// The letters of pictures: a subset of Inter that is part of the library (src/render/font, made by script/font).
#pragma once

#include <cstdint>
#include <vector>

namespace standoff {

/// In units of the font, y upwards from the baseline; kFontUnits are the nominal height of a line.
struct FontPoint {
  double x = 0, y = 0;
};
inline constexpr double kFontUnits = 2816;
inline constexpr double kCapHeight = 2048;  ///< of letters like H

/// A quadratic Bezier curve; in a straight piece `control` lies on it.
struct FontCurve {
  FontPoint from, control, to;
};

/// The number of a character's drawing. Characters that the font lacks have number 0, a box.
std::uint32_t glyph_of(char32_t character);
/// How far the next letter stands from this one.
double advance_of(std::uint32_t glyph);
/// What is added to that between these two letters.
double kerning_of(std::uint32_t first, std::uint32_t second);
/// The closed curves around a letter, all in one list. What they wind around is filled.
std::vector<FontCurve> outline_of(std::uint32_t glyph);

}  // namespace standoff
