// SPDX-License-Identifier: Apache-2.0
#include "render/slice_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "core/guarded.h"
#include "render/legend.h"
#include "render/text.h"
#include "render/zero_line.h"
#include "standoff/error.h"

namespace standoff {
namespace {

constexpr Color kPaper{255, 255, 255}, kInk{40, 44, 52}, kFaint{110, 116, 126};
constexpr int kMaxSide = 8192;
constexpr int kMargin = 20, kGap = 28, kLine = 22;
constexpr double kTextSize = 15;
constexpr int kMinLegend = 160;  // pixels: lower, its numbers would touch

struct Extent {
  int width, height;
};

// The plane's pixels: samples of the closer axis become whole squares, those of the other as long as space asks.
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

std::optional<Legend> legend_of(const Plane& plane, double thickness, Colormap map) {
  float least = std::numeric_limits<float>::infinity(), greatest = -least;
  for (const float value : plane.values) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  if (!(least <= greatest)) return std::nullopt;
  return Legend(least, greatest, static_cast<float>(thickness), map);
}

bool has_sign(const DistanceField& field) {
  const auto negative = [](auto number) { return number < 0; };
  return !field.provenance().sign.empty() || std::ranges::count(field.slots(), DistanceField::kInside) > 0 ||
         std::ranges::any_of(field.tile_values(), negative);
}

// Dark on light colors, light on dark ones.
void draw_zero_line(const Plane& plane, Colormap map, SlicePicture& picture) {
  const Color line = map == Colormap::diverging ? kInk : kPaper;
  const std::vector<float> covered = zero_line(plane, picture.width, picture.height);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const float share = covered[static_cast<std::size_t>(y) * picture.width + x];
      if (share == 0) continue;
      picture.image.blend(picture.left + x, picture.top + y, line, share);
    }
}

}  // namespace

SlicePicture draw_slice(const DistanceField& field, const SliceOptions& options) {
  if (options.pixels < 1 || options.pixels > kMaxSide)
    throw Error(ErrorCode::usage,
                "slice: the picture's size must be 1 to " + std::to_string(kMaxSide) + " pixels; 512 is usual");
  const Plane plane = plane_of(field, options);
  const auto [width, height] = enlarged(plane, options.pixels);
  const bool is_signed = has_sign(field);
  Colormap map = options.colormap;
  if (map == Colormap::automatic) map = is_signed ? Colormap::diverging : Colormap::viridis;
  const std::optional<Legend> legend = legend_of(plane, field.thickness(), map);

  const std::array<std::string, 2> caption{std::string(legend ? "distance" : "no finite distance") + " at " +
                                               plane.normal + " = " + short_text(plane.position, 6),
                                           "sample " + std::to_string(plane.index) + " of 0-" +
                                               std::to_string(plane.count - 1) + ", " + plane.right + " right, " +
                                               plane.up + " up"};
  const double words = std::max(text_width(caption[0], kTextSize), text_width(caption[1], kTextSize));
  const int body = std::max(width + (legend ? kGap + legend->width() : 0), static_cast<int>(std::ceil(words)));
  const int top = kMargin + 2 * kLine + kMargin / 2;
  const int legend_height = std::max(height, kMinLegend);
  SlicePicture picture{Image(body + 2 * kMargin, top + legend_height + kMargin, kPaper), kMargin, top, width, height};

  const double baseline = kMargin + cap_height(kTextSize);
  draw_text(picture.image, kMargin, baseline, caption[0], kTextSize, kInk);
  draw_text(picture.image, kMargin, baseline + kLine, caption[1], kTextSize, kFaint);
  if (legend) legend->draw(picture.image, kMargin + width + kGap, top, legend_height);
  const Legend grey(0, 0, field.thickness(), map);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      // The sample whose cell holds the pixel's centre; rows of the picture run down.
      const std::int64_t r = (2 * x + 1) * plane.width / (2 * width);
      const std::int64_t u = (2 * (height - y) - 1) * plane.height / (2 * height);
      picture.image.at(kMargin + x, top + y) = (legend ? *legend : grey).color(plane.value(r, u));
    }
  if (is_signed) draw_zero_line(plane, map, picture);
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
