// SPDX-License-Identifier: Apache-2.0
// TrueType as far as our own font goes (OpenType 1.9: cmap 12, glyf without references, hmtx, kern 0). The font is part
// of the program and its bytes are tested, so they are not checked here.
#include "render/font.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace standoff {

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

}  // namespace standoff
