// SPDX-License-Identifier: Apache-2.0
#include "render/colormap.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace standoff {
namespace {

// Viridis (van der Walt, Smith; CC0) at 33 even steps; lines between them stay within 2 of 255 of the original.
constexpr std::array<Color, 33> kViridis{{
    {68, 1, 84},    {71, 13, 96},   {72, 24, 106},  {72, 35, 116},  {71, 45, 123},  {69, 54, 129},  {66, 64, 134},
    {63, 73, 137},  {59, 82, 139},  {55, 90, 141},  {51, 99, 141},  {47, 106, 142}, {44, 114, 142}, {41, 122, 142},
    {38, 129, 142}, {35, 137, 142}, {33, 144, 140}, {31, 152, 139}, {31, 159, 136}, {33, 166, 133}, {40, 174, 128},
    {49, 181, 123}, {62, 188, 116}, {76, 194, 108}, {93, 201, 99},  {110, 206, 88}, {130, 211, 76}, {150, 216, 63},
    {171, 220, 50}, {192, 223, 36}, {213, 226, 26}, {234, 229, 26}, {253, 231, 37},
}};
// Pure red, green and blue, over yellow and cyan.
constexpr std::array<Color, 5> kThesis{{{255, 0, 0}, {255, 255, 0}, {0, 255, 0}, {0, 255, 255}, {0, 0, 255}}};
// Even steps of lightness in OKLab (Ottosson 2020), from 0.43 over 0.975 to 0.43, at the hues 255 and 28 degrees. The
// chroma of both sides is 0.15 sin(min(1, 1.45 s) pi / 2) at the share s of a side, as far as sRGB has such colors.
constexpr std::array<Color, 17> kDiverging{{{0, 78, 155},
                                            {22, 98, 181},
                                            {47, 118, 204},
                                            {69, 140, 226},
                                            {97, 161, 242},
                                            {130, 183, 251},
                                            {167, 205, 255},
                                            {206, 226, 253},
                                            {247, 247, 247},
                                            {251, 214, 209},
                                            {251, 183, 173},
                                            {244, 152, 140},
                                            {232, 123, 110},
                                            {213, 98, 86},
                                            {190, 76, 65},
                                            {167, 54, 46},
                                            {144, 31, 26}}};

template <std::size_t n>
Color between(const std::array<Color, n>& colors, double t) {
  const double at = std::clamp(t, 0.0, 1.0) * (n - 1);
  const auto below = std::min(static_cast<std::size_t>(at), n - 2);
  const double share = at - static_cast<double>(below);
  Color color;
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = static_cast<std::uint8_t>(std::lround(colors[below][c] * (1 - share) + colors[below + 1][c] * share));
  return color;
}

}  // namespace

Color color_of(Colormap map, double t) {
  if (map == Colormap::thesis) return between(kThesis, t);
  return map == Colormap::diverging ? between(kDiverging, t) : between(kViridis, t);
}

}  // namespace standoff
