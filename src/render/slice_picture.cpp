// SPDX-License-Identifier: Apache-2.0
// The picture of a slice: the plane in colors, lines, scales, legend and words.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "core/guarded.h"
#include "render/scales.h"
#include "render/slice.h"
#include "render/text.h"
#include "standoff/error.h"

namespace standoff {
namespace {

constexpr int kMaxSide = 8192;
constexpr double kUsualSliceSide =
    640;                            // of a plane that words of usual size stand beside; greater ones have greater words
constexpr double kSquareSide = 12;  // samples of so many pixels are shown as squares
// Pixels at scale 1.
constexpr double kSliceMargin = 20, kSliceGap = 26, kTitle = 19, kTitleLine = 27, kSliceText = 14, kTextLine = 26;
constexpr double kMinLegend = 190;  // lower, its numbers would touch
constexpr double kLevelsApart = 8;  // pixels between lines; nearer ones would hide the colors
constexpr double kLevelLine = 1, kZeroLevelLine = 1.8, kLevelLineShare = 0.4;

struct Extent {
  int width, height;
};

// The size of the plane in pixels: a sample has whole pixels along the axis of the smaller spacing, if there is room.
Extent enlarged(const Plane& plane, int pixels) {
  const double unit = std::min(plane.step_right, plane.step_up);
  const double width = static_cast<double>(plane.width) * (plane.step_right / unit);
  const double height = static_cast<double>(plane.height) * (plane.step_up / unit);
  const double longest = std::max(width, height);
  const double whole = std::max(1.0, std::ceil(pixels / longest));
  const double factor = std::min(whole, kMaxSide / longest);
  const auto side = [&](double length) { return static_cast<int>(std::max(1L, std::lround(length * factor))); };
  return {side(width), side(height)};
}

struct ValueRange {
  float least = std::numeric_limits<float>::infinity(), greatest = -least;
  bool empty() const { return !(least <= greatest); }
};

ValueRange finite_range(const Plane& plane) {
  ValueRange range;
  for (const float value : plane.values) {
    if (!std::isfinite(value)) continue;
    range.least = std::min(range.least, value);
    range.greatest = std::max(range.greatest, value);
  }
  return range;
}

bool as_squares(const Plane& plane, const SlicePicture& picture, Interpolation interpolation) {
  if (interpolation != Interpolation::automatic) return interpolation == Interpolation::nearest;
  return picture.width >= kSquareSide * static_cast<double>(plane.width) &&
         picture.height >= kSquareSide * static_cast<double>(plane.height);
}

void draw_squares(const Plane& plane, const Legend& legend, SlicePicture& picture) {
  const auto [width, height] = std::pair(picture.width, picture.height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      // The sample whose cell holds the pixel's centre; rows of the picture run down.
      const std::int64_t r = (2 * x + 1) * plane.width / (2 * width);
      const std::int64_t u = (2 * (height - y) - 1) * plane.height / (2 * height);
      picture.image.at(picture.left + x, picture.top + y) = legend.color(plane.value(r, u));
    }
}

void draw_between(const Plane& plane, const std::vector<float>& between, float thickness, const Legend& legend,
                  const Theme& theme, SlicePicture& picture) {
  const auto [width, height] = std::pair(picture.width, picture.height);
  const std::vector<float> edge = interpolated(beyond_band(plane, thickness), width, height);
  const std::vector<float> outside = share_above(edge, width, height, thickness);
  const std::vector<float> not_inside = share_above(edge, width, height, std::nextafter(-thickness, 0.0f));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t n = static_cast<std::size_t>(y) * width + x;
      const int px = picture.left + x, py = picture.top + y;
      picture.image.at(px, py) = std::isfinite(between[n]) ? legend.band_color(between[n]) : legend.color(between[n]);
      if (std::isnan(between[n])) continue;
      picture.image.blend(px, py, theme.outside, outside[n]);
      picture.image.blend(px, py, theme.inside, 1 - not_inside[n]);
    }
}

// Dark on light colors, light on dark ones.
Color contrast(const Color& color) {
  const double light = 0.3 * color[0] + 0.59 * color[1] + 0.11 * color[2];
  return light > 110 ? Color{20, 22, 28} : Color{255, 255, 255};
}

void draw_level(const std::vector<float>& between, double level, double line_width, double share,
                SlicePicture& picture) {
  const std::vector<float> covered = level_line(between, picture.width, picture.height, level, line_width);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const double part = covered[static_cast<std::size_t>(y) * picture.width + x] * share;
      if (part == 0) continue;
      const Color under = picture.image.at(picture.left + x, picture.top + y);
      picture.image.blend(picture.left + x, picture.top + y, contrast(under), part);
    }
}

// Draws what is nearer to the surface than `level`; `pixels`: of a world unit.
void draw_surface(const std::vector<float>& between, float level, double pixels, SlicePicture& picture) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const double inside = (level - between[static_cast<std::size_t>(y) * picture.width + x]) * pixels;
      if (inside > -0.5)
        picture.image.blend(picture.left + x, picture.top + y, {255, 255, 255}, std::min(inside + 0.5, 1.0));
    }
}

// Where the parts of the picture lie, and its words.
struct Layout {
  double scale = 1;
  std::string title, caption;
  AxisScale right, up;
  int legend_width = 0, legend_height = 0;
};

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " (" + unit + ")";
}

SlicePicture empty_picture(const Layout& layout, const Extent& plane, const Theme& theme) {
  const auto pixels = [&](double length) { return static_cast<int>(std::ceil(length * layout.scale)); };
  const int margin = pixels(kSliceMargin);
  const int left = margin + static_cast<int>(std::ceil(layout.up.widest()));
  const int top = margin + (layout.title.empty() ? 0 : pixels(kTitleLine)) + 2 * pixels(kTextLine);
  const int legend = layout.legend_width > 0 ? pixels(kSliceGap) + layout.legend_width : pixels(kSliceText);
  const double words =
      std::max(text_width(layout.title, kTitle * layout.scale), text_width(layout.caption, kSliceText * layout.scale));
  const int width = std::max(left + plane.width + legend, margin + static_cast<int>(std::ceil(words))) + margin;
  const int below = layout.right.height();
  const int bottom = std::max(top + plane.height + below, top - pixels(kTextLine) + layout.legend_height);
  return {Image(width, bottom + margin, theme.paper), left, top, plane.width, plane.height};
}

// Throws Error{usage} for words that make a picture which nothing can hold.
void check_words(const char* what, const std::string& words) {
  constexpr std::int64_t kMost = 200;
  const auto begins = [](char c) { return (c & 0xc0) != 0x80; };  // a character of UTF-8
  const std::int64_t characters = std::count_if(words.begin(), words.end(), begins);
  if (characters > kMost)
    throw Error(ErrorCode::usage, std::string("slice: the ") + what + " has " + std::to_string(characters) +
                                      " characters; give it at most " + std::to_string(kMost));
}

void draw_words(const Layout& layout, const Theme& theme, SlicePicture& picture) {
  const double margin = std::ceil(kSliceMargin * layout.scale), size = kSliceText * layout.scale;
  double baseline = margin + cap_height(size);
  if (!layout.title.empty()) {
    const double title = kTitle * layout.scale;
    draw_text(picture.image, margin, margin + cap_height(title), layout.title, title, theme.ink);
    baseline += std::ceil(kTitleLine * layout.scale);
  }
  draw_text(picture.image, margin, baseline, layout.caption, size, layout.title.empty() ? theme.ink : theme.faint);
}

}  // namespace

SlicePicture draw_slice(const DistanceField& field, const SliceOptions& options) {
  if (options.pixels < 1 || options.pixels > kMaxSide)
    throw Error(ErrorCode::usage,
                "slice: the picture's size must be 1 to " + std::to_string(kMaxSide) + " pixels; 512 is usual");
  if (options.background == Background::transparent)
    throw Error(ErrorCode::usage, "slice: there is no transparent background; take white or dark");
  check_words("title", options.title);
  check_words("unit", options.unit);
  check_words("legend", options.legend);
  const Plane plane = upright(plane_of(field, options), field.provenance().up);
  const Extent extent = enlarged(plane, options.pixels);
  const bool is_signed = field.has_sign();
  Colormap map = options.colormap;
  if (map == Colormap::automatic) map = is_signed ? Colormap::diverging : Colormap::viridis;
  ValueRange range = finite_range(plane);
  const auto end = !is_signed && options.colormap == Colormap::automatic ? early_end(plane.values) : std::nullopt;
  if (end) range.greatest = *end;
  const Theme theme = theme_of(options.background);
  const auto thickness = static_cast<float>(field.thickness());  // as values are clamped to it
  Legend legend(range.empty() ? 0 : range.least, range.empty() ? 0 : range.greatest, thickness, map, theme,
                options.legend.empty() ? with_unit("distance", options.unit) : options.legend);
  if (end) legend.end_early();

  SlicePicture picture{Image(extent.width, extent.height, theme.paper), 0, 0, extent.width, extent.height};
  Layout layout;
  if (!options.bare) {
    layout.scale = std::max(1.0, std::max(extent.width, extent.height) / kUsualSliceSide);
    layout.title = options.title;
    layout.caption = std::string(range.empty() ? "no finite distance at " : "") + plane.normal + " = " +
                     short_text(plane.position, 5) + (options.unit.empty() ? "" : " " + options.unit) + ", sample " +
                     std::to_string(plane.index) + " of 0–" + std::to_string(plane.count - 1);
    layout.right = AxisScale(with_unit({plane.right}, options.unit), plane.first_right, plane.step_right, plane.width,
                             extent.width, layout.scale);
    layout.up = AxisScale(with_unit({plane.up}, options.unit), plane.first_up, plane.step_up, plane.height,
                          extent.height, layout.scale);
    if (!range.empty()) {
      layout.legend_width = legend.width(layout.scale);
      const int heading = static_cast<int>(std::ceil(kTextLine * layout.scale));
      layout.legend_height = heading + std::max(extent.height, static_cast<int>(std::ceil(kMinLegend * layout.scale)));
    }
    picture = empty_picture(layout, extent, theme);
  }

  const std::vector<float> between = interpolated(plane, extent.width, extent.height);
  const bool squares = as_squares(plane, picture, options.interpolation);
  if (squares)
    draw_squares(plane, legend, picture);
  else
    draw_between(plane, between, thickness, legend, theme, picture);
  // Words grow with the picture, lines do not grow beyond what is drawn well.
  const double line = std::min(layout.scale, 2 / kZeroLevelLine);
  const double pixels = extent.width / (static_cast<double>(plane.width) * plane.step_right);  // of a world unit
  const std::vector<Tick>& ticks = legend.ticks();
  const bool apart = ticks.size() < 2 || (ticks[1].value - ticks[0].value) * pixels >= kLevelsApart * line;
  if (options.contours && !squares && apart)
    for (const Tick& tick : ticks)
      if (!range.empty() && tick.value != 0)
        draw_level(between, tick.value, kLevelLine * line, kLevelLineShare, picture);
  if (is_signed)
    draw_level(between, 0, kZeroLevelLine * line, 1, picture);
  else if (options.colormap == Colormap::automatic && !squares)
    draw_surface(between, surface_level(field), pixels, picture);
  if (options.bare) return picture;

  draw_words(layout, theme, picture);
  layout.right.draw_below(picture.image, picture.left, picture.top + picture.height, theme);
  layout.up.draw_beside(picture.image, picture.left, picture.top + picture.height, theme);
  if (!range.empty()) {
    const int heading = static_cast<int>(std::ceil(kTextLine * layout.scale));
    legend.draw(picture.image, picture.left + picture.width + static_cast<int>(std::ceil(kSliceGap * layout.scale)),
                picture.top - heading, layout.legend_height, layout.scale);
  }
  return picture;
}

void write_slice_png(const std::filesystem::path& path, const DistanceField& field, const SliceOptions& options,
                     Existing existing) try {
  require_png();
  write_png(path, draw_slice(field, options).image, existing);
} catch (...) {
  throw_as_error("slice", "take fewer pixels, or provide more memory");
}

}  // namespace standoff
