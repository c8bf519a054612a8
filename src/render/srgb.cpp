// SPDX-License-Identifier: Apache-2.0
#include "render/srgb.h"

#include <array>
#include <vector>

namespace standoff {
namespace {

constexpr int kLinearSteps = 1 << 14;  // of linear light: the darkest colors of 8 bits are five steps apart

// IEC 61966-2-1, for a share of 255.
double decoded(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

struct SrgbTables {
  std::array<float, 256> light;
  std::array<std::uint8_t, kLinearSteps + 1> code;

  SrgbTables() {
    // Rounded to whole steps: the last bits of std::pow differ between machines.
    for (std::size_t c = 0; c < 256; ++c)
      light[c] = static_cast<float>(std::lround(decoded(static_cast<double>(c) / 255) * 65536)) / 65536;
    std::size_t c = 0;
    for (int step = 0; step <= kLinearSteps; ++step) {
      while (c < 255 && step > std::lround(decoded((static_cast<double>(c) + 0.5) / 255) * kLinearSteps)) ++c;
      code[static_cast<std::size_t>(step)] = static_cast<std::uint8_t>(c);
    }
  }
};

const SrgbTables& srgb_tables() {
  static const SrgbTables made;
  return made;
}

std::uint8_t code_of(const SrgbTables& t, float light) {
  return t.code[static_cast<std::size_t>(std::clamp(light, 0.0F, 1.0F) * kLinearSteps + 0.5F)];
}

}  // namespace

Float3 linear_of(Color color) {
  const SrgbTables& t = srgb_tables();
  return {t.light[color[0]], t.light[color[1]], t.light[color[2]]};
}

Color color_of_light(Float3 linear) {
  const SrgbTables& t = srgb_tables();
  return {code_of(t, linear.x), code_of(t, linear.y), code_of(t, linear.z)};
}

}  // namespace standoff
