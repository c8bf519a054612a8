// SPDX-License-Identifier: Apache-2.0
// Words on pictures, and what they are drawn from: the outlines of letters, and how much of each pixel an outline
// covers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

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

/// A point of a letter. The font is a subset of Inter that is part of the library (src/render/font, made by
/// script/font). Its units: y points upwards from the baseline, kFontUnits are the nominal height of a line.
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
/// What is added to the advance between these two letters.
double kerning_of(std::uint32_t first, std::uint32_t second);
/// The closed curves around a letter, all in one list. What they wind around is filled.
std::vector<FontCurve> outline_of(std::uint32_t glyph);

/// A window of pixels that closed outlines are drawn into, line by line. What they wind around once, either way, counts
/// as covered. Exact but for rounding: a pixel's share is the area of its square inside the outline.
class Coverage {
 public:
  Coverage(int width, int height);

  /// A line of an outline, in pixels from the window's top left corner. All of an outline's lines must be added, also
  /// those outside the window; any finite numbers are fine.
  void add_line(double x0, double y0, double x1, double y1);
  /// The shares of all pixels from 0 to 1, row by row.
  std::vector<float> shares() const;

 private:
  void add_in_row(int row, double x0, double x1, double height);

  int width_, height_;
  // The change of the covered share from the pixel before; one more in a row than pixels.
  std::vector<double> changes_;
};

}  // namespace standoff
