// SPDX-License-Identifier: Apache-2.0
#include "render/text.h"

#include <algorithm>
#include <cmath>

#include "render/coverage.h"
#include "render/font.h"

namespace standoff {
namespace {

constexpr char32_t kReplacement = 0xFFFD;
constexpr double kFlatness = 0.04;  // pixels between a curve and the lines it is drawn as

struct Placed {
  std::uint32_t glyph;
  double x;  // from the beginning of the text, pixels
};

// The letters of a text, and at the end glyph 0, where the next one would stand.
std::vector<Placed> set_type(std::string_view text, double size) {
  std::vector<Placed> letters;
  double x = 0;
  std::uint32_t before = 0;
  for (const char32_t character : characters_of(text)) {
    const std::uint32_t glyph = glyph_of(character);
    x += kerning_of(before, glyph);
    letters.push_back({glyph, x * size / kFontUnits});
    x += advance_of(glyph);
    before = glyph;
  }
  letters.push_back({0, x * size / kFontUnits});
  return letters;
}

void add_curve(const FontCurve& curve, Coverage& coverage) {
  const auto& [a, b, c] = curve;
  const double bend_x = a.x - 2 * b.x + c.x, bend_y = a.y - 2 * b.y + c.y;
  const double bend = std::sqrt(bend_x * bend_x + bend_y * bend_y) / 4;
  const double pieces = std::clamp(std::ceil(std::sqrt(bend / kFlatness)), 1.0, 64.0);
  FontPoint from = a;
  for (double n = 1; n <= pieces; ++n) {
    const double t = n / pieces, s = 1 - t;
    const FontPoint to = n == pieces ? c
                                     : FontPoint{s * s * a.x + 2 * s * t * b.x + t * t * c.x,
                                                 s * s * a.y + 2 * s * t * b.y + t * t * c.y};
    coverage.add_line(from.x, from.y, to.x, to.y);
    from = to;
  }
}

void draw_letter(Image& image, double x, double baseline, std::uint32_t glyph, double size, Color color) {
  std::vector<FontCurve> curves = outline_of(glyph);
  double left = image.width, top = image.height, right = 0, bottom = 0;
  for (FontCurve& curve : curves)
    for (FontPoint* point : {&curve.from, &curve.control, &curve.to}) {
      *point = {x + point->x * size / kFontUnits, baseline - point->y * size / kFontUnits};
      left = std::min(left, point->x);
      right = std::max(right, point->x);
      top = std::min(top, point->y);
      bottom = std::max(bottom, point->y);
    }
  const auto within = [](double place, int length) { return static_cast<int>(std::clamp<double>(place, 0, length)); };
  const int first_x = within(std::floor(left), image.width), first_y = within(std::floor(top), image.height);
  const int width = within(std::ceil(right), image.width) - first_x;
  const int height = within(std::ceil(bottom), image.height) - first_y;
  if (width <= 0 || height <= 0) return;
  Coverage coverage(width, height);
  for (FontCurve& curve : curves) {
    for (FontPoint* point : {&curve.from, &curve.control, &curve.to}) {
      point->x -= first_x;
      point->y -= first_y;
    }
    add_curve(curve, coverage);
  }
  const std::vector<float> shares = coverage.shares();
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      image.blend(first_x + column, first_y + row, color, shares[static_cast<std::size_t>(row) * width + column]);
}

}  // namespace

double cap_height(double size) { return size * kCapHeight / kFontUnits; }

double text_width(std::string_view text, double size) { return set_type(text, size).back().x; }

void draw_text(Image& image, double x, double baseline, std::string_view text, double size, Color color) {
  std::vector<Placed> letters = set_type(text, size);
  letters.pop_back();
  for (const auto& [glyph, at] : letters) draw_letter(image, x + at, baseline, glyph, size, color);
}

std::u32string characters_of(std::string_view text) {
  std::u32string characters;
  for (std::size_t n = 0; n < text.size();) {
    const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(text[at]); };
    const std::uint8_t lead = byte(n++);
    if (lead < 0x80) {
      characters += lead;
      continue;
    }
    const int more = lead >= 0xC2 && lead < 0xE0   ? 1
                     : lead >= 0xE0 && lead < 0xF0 ? 2
                     : lead >= 0xF0 && lead < 0xF5 ? 3
                                                   : 0;
    char32_t character = lead & (0x3F >> more);
    int found = 0;
    for (; found < more && n < text.size(); ++found, ++n) {
      // The second byte is bounded so that nothing is longer than it need be, a surrogate, or past U+10FFFF.
      const std::uint8_t least = found > 0 ? 0x80 : lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
      const std::uint8_t most = found > 0 ? 0xBF : lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
      if (byte(n) < least || byte(n) > most) break;
      character = character << 6 | (byte(n) & 0x3Fu);
    }
    characters += more > 0 && found == more ? character : kReplacement;
  }
  return characters;
}

}  // namespace standoff
