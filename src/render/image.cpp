// SPDX-License-Identifier: Apache-2.0
// Pixels as a PNG file, and colors: those of numbers, and between files and linear light.
#include "render/image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "files/atomic_file.h"
#include "standoff/error.h"

#ifdef STANDOFF_HAVE_PNG
#include <png.h>
#endif

namespace standoff {

#ifdef STANDOFF_HAVE_PNG

void require_png() {}

std::vector<std::uint8_t> png_of(const Image& image) {
  // libpng's simplified interface reports errors without longjmp, which must not skip destructors.
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = image.alpha.empty() ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  header.flags = PNG_IMAGE_FLAG_FAST;  // a third of the time; files of pictures are about as large
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<std::uint8_t> encoded(bytes);
  std::vector<std::uint8_t> with_alpha;
  for (std::size_t n = 0; n < image.alpha.size(); ++n) {
    with_alpha.insert(with_alpha.end(), image.pixels[n].begin(), image.pixels[n].end());
    with_alpha.push_back(image.alpha[n]);
  }
  const void* const pixels = image.alpha.empty() ? static_cast<const void*>(image.pixels.data()) : with_alpha.data();
  if (!png_image_write_to_memory(&header, encoded.data(), &bytes, 0, pixels, 0, nullptr))
    throw Error(ErrorCode::internal,
                std::string("libpng cannot encode the picture: ") + header.message + "; please report this");
  encoded.resize(bytes);
  return encoded;
}

#else

void require_png() {
  throw Error(
      ErrorCode::usage,
      "pictures need libpng, which this build of standoff lacks; install it (Debian: libpng-dev) and build again");
}

std::vector<std::uint8_t> png_of(const Image&) {
  require_png();
  return {};
}

#endif

void write_png(const std::filesystem::path& path, const Image& image, Existing existing) {
  AtomicFile file(path, existing);
  const std::vector<std::uint8_t> bytes = png_of(image);
  file.write(bytes.data(), bytes.size());
  file.commit();
}

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

Image without_paper(const Image& on_white, const Image& on_black) {
  Image picture = on_black;
  picture.alpha.resize(picture.pixels.size());
  for (std::size_t n = 0; n < picture.pixels.size(); ++n) {
    // Viewers blend what is stored, without its linear light: channels differ a little in how much shines through.
    int paper = 0;
    for (std::size_t c = 0; c < 3; ++c) paper += on_white.pixels[n][c] - on_black.pixels[n][c];
    const int opaque = 255 - std::max((paper + 1) / 3, 0);
    picture.alpha[n] = static_cast<std::uint8_t>(opaque);
    for (std::uint8_t& channel : picture.pixels[n])
      channel = static_cast<std::uint8_t>(opaque > 0 ? std::min(255, (channel * 255 + opaque / 2) / opaque) : 0);
  }
  return picture;
}

}  // namespace standoff
