// SPDX-License-Identifier: Apache-2.0
// Words on pictures.
#pragma once

#include <string>
#include <string_view>

#include "render/image.h"

namespace standoff {

/// The height in pixels of letters like H, of a text whose size is `size` pixels; lines stand about 1.5 sizes apart.
double cap_height(double size);

/// The width of a text in pixels: where the next letter would stand.
double text_width(std::string_view text, double size);

/// Writes a text in UTF-8 on its baseline, whose left end is (x, baseline) in pixels from the picture's top left
/// corner. Edges are smooth, letters stand at fractions of pixels. Characters that the font lacks, control characters
/// among them, are boxes; bytes that are no UTF-8 are replacement characters. What lies outside the picture is cut off.
void draw_text(Image& image, double x, double baseline, std::string_view text, double size, Color color);

/// The characters of a text; U+FFFD in place of each longest run of bytes that begins a character and does not end it,
/// as the Unicode standard recommends.
std::u32string characters_of(std::string_view text);

}  // namespace standoff
