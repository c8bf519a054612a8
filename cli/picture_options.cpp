// SPDX-License-Identifier: Apache-2.0
#include "cli/picture_options.h"

#include <array>
#include <cmath>
#include <string>

#include "cli/options.h"
#include "cli/parse.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

// "1920x1080".
void parse_pixels(const std::string& option, const std::string& text, PictureOptions& options) {
  const std::size_t x = text.find('x');
  if (x == std::string::npos)
    throw Error(ErrorCode::usage, option + " '" + text + "': give width and height in pixels, as 1920x1080");
  options.width = static_cast<int>(parse_count(option, text.substr(0, x), 16, 8192));
  options.height = static_cast<int>(parse_count(option, text.substr(x + 1), 16, 8192));
}

// "front", or "35,25", or "35,25,2".
void parse_camera(const std::string& option, const std::string& text, PictureOptions& options) {
  struct Preset {
    const char* name;
    double azimuth_deg, elevation_deg;
  };
  constexpr std::array<Preset, 7> kPresets{{{"front", 0, 0},
                                            {"back", 180, 0},
                                            {"right", 90, 0},
                                            {"left", -90, 0},
                                            {"top", 0, 90},
                                            {"bottom", 0, -90},
                                            {"iso", 45, 35.264389682754654}}};
  for (const Preset& preset : kPresets)
    if (text == preset.name) {
      options.azimuth_deg = preset.azimuth_deg;
      options.elevation_deg = preset.elevation_deg;
      return;
    }
  const auto refuse = [&] {
    throw Error(ErrorCode::usage,
                option + " '" + text +
                    "': give front, back, left, right, top, bottom or iso, or AZIMUTH,ELEVATION[,ZOOM] "
                    "in degrees, as 35,25 (elevation -90 to 90, zoom 0.01 to 100)");
  };
  if (text.find_first_not_of("0123456789+-.,eE ") != std::string::npos) refuse();
  std::vector<double> numbers;
  try {
    numbers = numbers_in(text);
  } catch (const Error&) {
    refuse();
  }
  if (numbers.size() < 2 || numbers.size() > 3 || std::abs(numbers[1]) > 90) refuse();
  if (numbers.size() == 3 && !(numbers[2] >= 0.01 && numbers[2] <= 100)) refuse();
  options.azimuth_deg = numbers[0];
  options.elevation_deg = numbers[1];
  if (numbers.size() == 3) options.zoom = numbers[2];
}

}  // namespace

std::vector<const CLI::Option*> add_picture_options(CLI::App& verb, PictureOptions& options) {
  std::vector<const CLI::Option*> all;
  const auto add = [&](const char* name, const char* value, const std::string& help, auto set) {
    all.push_back(add_parsed(verb, {name, value, help.c_str(), kPictureGroup}, set));
  };
  const auto without = [&](const char* name, bool& value, const char* help) {
    all.push_back(verb.add_flag_callback(
                          name, [&value] { value = false; }, help)
                      ->group(kPictureGroup));
  };
  const std::string size = std::to_string(options.width) + "x" + std::to_string(options.height);
  add("--size", "WxH", "pixels, 16 to 8192 each (default " + size + ")",
      [&options](S o, S t) { parse_pixels(o, t, options); });
  add("--camera", "VIEW",
      "front, back, left, right, top, bottom, iso, or degrees:\nAZIMUTH,ELEVATION[,ZOOM] (default " +
          std::to_string(std::lround(options.azimuth_deg)) + "," + std::to_string(std::lround(options.elevation_deg)) +
          ",1)",
      [&options](S o, S t) { parse_camera(o, t, options); });
  const bool y_up = options.up == Axis::y;
  add("--up", "A", std::string("the axis that points up: x, ") + (y_up ? "y (default) or z" : "y or z (default)"),
      [&options](S o, S t) { options.up = parse_axis(o, t); });
  without("--parallel", options.perspective, "parallel rays: no perspective");
  add("--samples", "N", "for each pixel: 1, 2, 4 (default), 8 or 16", [&options](S o, S t) {
    options.samples = 1 << parse_choice(o, t, {"1", "2", "4", "8", "16"});
  });
  add("--background", "NAME", "white (default) or dark", [&options](S o, S t) {
    options.background = static_cast<Background>(parse_choice(o, t, {"white", "dark"}));
  });
  without("--no-legend", options.legend, "no legend");
  return all;
}

}  // namespace standoff::cli
