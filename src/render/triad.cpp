// SPDX-License-Identifier: Apache-2.0
#include "render/triad.h"

#include <algorithm>
#include <array>

#include "render/text.h"

namespace standoff {
namespace {

constexpr double kLength = 38, kWidth = 2.2, kLetter = 14, kLetterGap = 9;  // pixels at scale 1

// A line with round ends and smooth edges.
void draw_line(Image& image, Float3 from, Float3 to, double width, Color color) {
  const Float3 d = to - from;
  const float length_sq = dot(d, d);
  const auto before = [&](float a, float b) { return static_cast<int>(std::min(a, b) - width); };
  const auto after = [&](float a, float b) { return static_cast<int>(std::max(a, b) + width); };
  for (int y = before(from.y, to.y); y <= after(from.y, to.y); ++y)
    for (int x = before(from.x, to.x); x <= after(from.x, to.x); ++x) {
      const Float3 p = Float3{static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F, 0} - from;
      const float t = length_sq > 0 ? std::clamp(dot(p, d) / length_sq, 0.0F, 1.0F) : 0;
      const double covered = std::clamp(0.5 * width + 0.5 - length(p - d * t), 0.0, 1.0);
      if (covered > 0) image.blend(x, y, color, covered);
    }
}

}  // namespace

void draw_triad(Image& image, const Camera& camera, const Theme& theme, int margin, double scale) {
  struct Arrow {
    const char* name;
    Float3 seen;
    Color color;
  };
  std::array<Arrow, 3> arrows{{{"x", camera.turned({1, 0, 0}), {214, 60, 52}},
                               {"y", camera.turned({0, 1, 0}), {46, 150, 72}},
                               {"z", camera.turned({0, 0, 1}), {52, 110, 214}}}};
  // The one that points at the eye comes last, over the others.
  std::ranges::stable_sort(arrows, {}, [](const Arrow& arrow) { return arrow.seen.z; });
  const double reach = (kLength + kLetterGap + kLetter / 2) * scale;
  const Float3 middle{static_cast<float>(margin + reach), static_cast<float>(image.height - margin - reach), 0};
  for (const Arrow& arrow : arrows) {
    const Float3 along{arrow.seen.x, -arrow.seen.y, 0};
    const Float3 tip = middle + along * static_cast<float>(kLength * scale);
    draw_line(image, middle, tip, kWidth * scale, arrow.color);
    const Float3 at = tip + unit_or(along, {0, -1, 0}) * static_cast<float>(kLetterGap * scale);
    const double size = kLetter * scale;
    draw_text(image, at.x - 0.5 * text_width(arrow.name, size), at.y + 0.35 * cap_height(size), arrow.name, size,
              theme.ink);
  }
}

}  // namespace standoff
