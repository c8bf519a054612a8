// SPDX-License-Identifier: Apache-2.0
#include "render/text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>

namespace standoff {

// TrueType as far as our own font goes (OpenType 1.9: cmap 12, glyf without references, hmtx, kern 0). The font is part
// of the program and its bytes are tested, so they are not checked here.
extern const std::string_view kInterFont;

namespace {

// Big-endian numbers at an offset of the font.
std::uint32_t u8(std::size_t at) { return static_cast<std::uint8_t>(kInterFont[at]); }
std::uint32_t u16(std::size_t at) { return u8(at) << 8 | u8(at + 1); }
std::int32_t i16(std::size_t at) { return static_cast<std::int16_t>(u16(at)); }
std::uint32_t u32(std::size_t at) { return u16(at) << 16 | u16(at + 2); }

std::size_t table(std::string_view tag) {
  for (std::size_t n = 0; n < u16(4); ++n)
    if (kInterFont.substr(12 + 16 * n, 4) == tag) return u32(12 + 16 * n + 8);
  return 0;
}

// Where the tables are, looked up once.
struct FontTables {
  std::size_t cmap = table("cmap"), glyf = table("glyf"), loca = table("loca"), hmtx = table("hmtx"),
              kern = table("kern");
  std::uint32_t wide = u16(table("hhea") + 34);  // letters with an advance of their own
  bool long_offsets = u16(table("head") + 50) == 1;
};
const FontTables& font_tables() {
  static const FontTables found;
  return found;
}

std::size_t glyph_at(std::uint32_t glyph) {
  const FontTables& t = font_tables();
  return t.glyf + (t.long_offsets ? u32(t.loca + 4 * glyph) : 2 * u16(t.loca + 2 * glyph));
}

struct OutlinePoint {
  FontPoint at;
  bool on_curve = false;
};

enum Flag : std::uint32_t { kOnCurve = 1, kShortX = 2, kShortY = 4, kRepeat = 8, kSameX = 16, kSameY = 32 };

std::vector<std::uint32_t> read_flags(std::size_t& at, std::size_t count) {
  std::vector<std::uint32_t> flags;
  while (flags.size() < count) {
    const std::uint32_t flag = u8(at++);
    flags.insert(flags.end(), flag & kRepeat ? 1 + u8(at++) : 1, flag);
  }
  return flags;
}

std::int32_t step(std::size_t& at, bool is_short, bool same) {
  if (is_short) return static_cast<std::int32_t>(u8(at++)) * (same ? 1 : -1);
  if (same) return 0;
  at += 2;
  return i16(at - 2);
}

FontPoint middle(FontPoint a, FontPoint b) { return {(a.x + b.x) / 2, (a.y + b.y) / 2}; }

// Between two points off the curve lies one on it that is not stored.
void add_contour(const std::vector<OutlinePoint>& points, std::vector<FontCurve>& curves) {
  const std::size_t count = points.size();
  const OutlinePoint& last = points[count - 1];
  FontPoint from = last.on_curve ? last.at : middle(last.at, points[0].at);
  for (std::size_t n = 0; n < count; ++n) {
    const OutlinePoint& next = points[(n + 1) % count];
    if (points[n].on_curve) {
      from = points[n].at;
      if (next.on_curve) curves.push_back({from, middle(from, next.at), next.at});
      continue;
    }
    const FontPoint to = next.on_curve ? next.at : middle(points[n].at, next.at);
    curves.push_back({from, points[n].at, to});
    from = to;
  }
}

}  // namespace

std::uint32_t glyph_of(char32_t character) {
  const std::size_t map = font_tables().cmap + u32(font_tables().cmap + 8);
  const std::uint32_t groups = u32(map + 12);
  for (std::size_t group = map + 16; group < map + 16 + 12 * std::size_t{groups}; group += 12)
    if (character >= u32(group) && character <= u32(group + 4)) return u32(group + 8) + (character - u32(group));
  return 0;
}

double advance_of(std::uint32_t glyph) {
  return u16(font_tables().hmtx + 4 * std::size_t{std::min(glyph, font_tables().wide - 1)});
}

double kerning_of(std::uint32_t first, std::uint32_t second) {
  const std::size_t pairs = font_tables().kern + 18;
  const std::uint32_t wanted = first << 16 | second;
  std::size_t low = 0, high = u16(font_tables().kern + 10);
  while (low < high) {
    const std::size_t at = (low + high) / 2;
    const std::uint32_t pair = u32(pairs + 6 * at);
    if (pair == wanted) return i16(pairs + 6 * at + 4);
    pair < wanted ? low = at + 1 : high = at;
  }
  return 0;
}

std::vector<FontCurve> outline_of(std::uint32_t glyph) {
  std::vector<FontCurve> curves;
  const std::size_t begin = glyph_at(glyph);
  if (begin == glyph_at(glyph + 1)) return curves;  // a space
  const auto contours = static_cast<std::size_t>(i16(begin));
  const std::size_t ends = begin + 10, count = u16(ends + 2 * (contours - 1)) + 1;
  std::size_t at = ends + 2 * contours;
  at += 2 + u16(at);  // instructions, of which there are none
  const std::vector<std::uint32_t> flags = read_flags(at, count);
  std::vector<OutlinePoint> points(count);
  std::int32_t x = 0, y = 0;
  for (std::size_t n = 0; n < count; ++n) points[n].at.x = x += step(at, flags[n] & kShortX, flags[n] & kSameX);
  for (std::size_t n = 0; n < count; ++n) points[n].at.y = y += step(at, flags[n] & kShortY, flags[n] & kSameY);
  for (std::size_t n = 0; n < count; ++n) points[n].on_curve = flags[n] & kOnCurve;
  std::size_t first = 0;
  for (std::size_t contour = 0; contour < contours; ++contour) {
    const std::size_t end = u16(ends + 2 * contour) + 1;
    add_contour(
        {points.begin() + static_cast<std::ptrdiff_t>(first), points.begin() + static_cast<std::ptrdiff_t>(end)},
        curves);
    first = end;
  }
  return curves;
}

// After the accumulation buffer of font-rs (Levien 2016): each line adds the area to its right.
Coverage::Coverage(int width, int height)
    : width_(width),
      height_(height),
      changes_(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height)) {}

void Coverage::add_line(double x0, double y0, double x1, double y1) {
  if (y0 == y1) return;
  const double sign = y0 < y1 ? 1 : -1;
  if (sign < 0) {
    std::swap(x0, x1);
    std::swap(y0, y1);
  }
  const double slope = (x1 - x0) / (y1 - y0);
  const double top = std::max(y0, 0.0), bottom = std::min(y1, static_cast<double>(height_));
  for (double y = top; y < bottom;) {
    const double row = std::floor(y), next = std::min(row + 1, bottom);
    add_in_row(static_cast<int>(row), x0 + (y - y0) * slope, x0 + (next - y0) * slope, sign * (next - y));
    y = next;
  }
}

// A piece within a row: cut where it passes from one pixel to the next.
void Coverage::add_in_row(int row, double x0, double x1, double height) {
  if (x0 > x1) std::swap(x0, x1);
  const double left = std::clamp(x0, 0.0, static_cast<double>(width_)),
               right = std::clamp(x1, 0.0, static_cast<double>(width_));
  double* changes = changes_.data() + static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(row);
  const double per_x = x1 > x0 ? height / (x1 - x0) : 0;
  // What lies left of the window covers all of it; what lies right of it, nothing.
  if (x0 >= width_) return;
  changes[0] += x1 <= 0 ? height : (left - x0) * per_x;
  if (x1 <= 0) return;
  if (left == right) {
    const auto pixel = static_cast<int>(left);
    const double share = left - pixel;
    changes[pixel] += height * (1 - share);
    changes[pixel + 1] += height * share;
    return;
  }
  for (double x = left; x < right;) {
    const double pixel = std::floor(x), next = std::min(pixel + 1, right);
    const double part = (next - x) * per_x, share = (x + next) / 2 - pixel;
    changes[static_cast<int>(pixel)] += part * (1 - share);
    changes[static_cast<int>(pixel) + 1] += part * share;
    x = next;
  }
}

std::vector<float> Coverage::shares() const {
  std::vector<float> shares;
  shares.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int row = 0; row < height_; ++row) {
    const double* change = changes_.data() + static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(row);
    double covered = 0;
    for (int x = 0; x < width_; ++x)
      shares.push_back(static_cast<float>(std::min(1.0, std::abs(covered += change[x]))));
  }
  return shares;
}

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
