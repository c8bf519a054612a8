// SPDX-License-Identifier: Apache-2.0
#include "cli/options.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <thread>

#include "cli/parse.h"
#include "cli/text.h"
#include "standoff/error.h"
#include "standoff/thesis.h"

namespace standoff::cli {

namespace {

std::string device_help(bool several) {
  std::vector<std::string> names;
  for (const BackendInfo& info : kBackends) {
    names.push_back(std::string(info.name) + (info.backend == Backend{} ? " (default)" : ""));
    if (info.backend == Backend::cuda) names.push_back(std::string(info.name) + (several ? ":N[,N...]" : ":N"));
  }
  return wrapped(joined(names) + "; see standoff devices", kHelpColumns);
}

}  // namespace

CLI::Option* add_device(CLI::App& verb, const char* group, Backend& backend, int& device) {
  return add_parsed(verb, {"--device", "NAME", device_help(false).c_str(), group},
                    [&](S o, S t) { backend = parse_backend(o, t, device); });
}

CLI::Option* add_devices(CLI::App& verb, const char* group, Backend& backend, std::vector<int>& devices) {
  return add_parsed(verb, {"--device", "NAME", device_help(true).c_str(), group},
                    [&](S o, S t) { devices = parse_devices(o, t, backend); });
}

void add_uncompressed(CLI::App& verb, bool& uncompressed) {
  verb.add_flag("--uncompressed", uncompressed,
                "write the samples of .vti, .nrrd and .npz as they are: larger\nfiles that are read faster")
      ->group("Output");
}

void add_levels(CLI::App& verb, int& levels) {
  add_parsed(verb,
             {"--levels", "N",
              "give a .zarr store so many levels, each of every second sample\nof the one before (default 1: the field "
              "alone)",
              "Output"},
             [&levels](S o, S t) { levels = static_cast<int>(parse_count(o, t, 1, 32)); });
}

namespace {

// TBB never starts more than this, and warns on stderr when it is asked to.
std::int64_t most_threads() { return std::clamp(4 * std::thread::hardware_concurrency(), 256u, unsigned{kMaxThreads}); }

}  // namespace

CLI::Option* add_threads(CLI::App& verb, const char* group, int& threads) {
  return add_parsed(verb, {"-j,--threads", "N", "threads (default: all)", group},
                    [&](S o, S t) { threads = static_cast<int>(parse_count(o, t, 1, most_threads())); });
}

void GridOptions::add_to(CLI::App& verb) {
  add_without_thickness_to(verb);
  add_parsed(verb,
             {"-t,--thickness", "T",
              "half-width of the band: world units (0.5), samples (3s),\nor inf for every sample (default)", "Grid"},
             [this](const std::string& o, const std::string& t) {
               thickness_ = parse_thickness(o, t);
               thickness_is_whole_ = t.find_first_not_of("0123456789") == t.npos;
             });
}

std::string GridOptions::doubt_of_thickness(const Box& mesh) const {
  constexpr double kLargeShare = 0.1;  // of the diagonal; bands are a few samples, of which there are hundreds
  constexpr double kMostSamples = 50;  // nobody means more
  const double diagonal = length(mesh.extent());
  if (!thickness_is_whole_ || thickness_.value > kMostSamples || thickness_.value <= kLargeShare * diagonal) return "";
  const std::string given = number(thickness_.value);
  return "--thickness " + given + " is " + given + " world units, and the mesh is " + number(diagonal) +
         " across; for " + given + " samples give -t " + given + "s, and -t " + given + ".0 if world units are meant";
}

void GridOptions::add_without_thickness_to(CLI::App& verb) {
  const auto add = [&verb](const char* name, const char* value, const char* help, auto set) {
    return add_parsed(verb, {name, value, help, "Grid"}, set);
  };
  const std::string default_samples = "samples on the longest side (default " + std::to_string(samples_) + ")";
  auto* samples = add("-r,--resolution", "N", default_samples.c_str(), [this](S o, S t) {
    samples_ = parse_count(o, t, 2, std::int64_t{1} << 40);
    samples_given_ = true;
  });
  auto* spacing = add("--spacing", "S[,S,S]", "distance between samples, one or per axis",
                      [this](S o, S t) { spacing_ = parse_spacing(o, t); });
  auto* size = add("--size", "NX,NY,NZ", "samples per axis; the spacing may then differ per axis",
                   [this](S o, S t) { size_ = parse_size(o, t); });
  auto* bounds = add("--bounds", "x0,..,z1", "cover this box (x0,y0,z0,x1,y1,z1) and not the mesh's",
                     [this](S o, S t) { bounds_ = parse_bounds(o, t); });
  auto* padding = add("--padding", "N",
                      "samples around the mesh (default: 2 for a full field; for a\nband its thickness, from 2 to a "
                      "tenth of the longest side)",
                      [this](S o, S t) {
                        padding_ = parse_number(o, t);
                        if (!(*padding_ >= 0))
                          throw Error(ErrorCode::usage, "--padding '" + t + "': give zero or more");
                      });
  spacing->excludes(samples);
  size->excludes(samples)->excludes(spacing);
  bounds->excludes(padding);
}

void GridOptions::add_thesis_to(CLI::App& verb) {
  auto* minimum =
      add_parsed(verb,
                 {"--minimum", "E", "the smallest grid for collision: E samples per thickness\n(2 to 4 in the thesis)",
                  kThesisGroup},
                 [this](S o, S t) { minimum_ = parse_number(o, t); });
  add_parsed(verb, {"--speed", "V", "with --minimum: how far a body moves in one step", kThesisGroup},
             [this](S o, S t) { speed_ = parse_number(o, t); })
      ->needs(minimum);
  for (const char* name : {"--resolution", "--spacing", "--size", "--bounds", "--padding"})
    minimum->excludes(verb.get_option(name));
  minimum->needs(verb.get_option("--thickness"));
}

Padding GridOptions::padding() const {
  if (bounds_) return {.least_samples = 0};
  if (padding_) {
    const auto leaves_none = [this](std::int64_t samples) {
      return samples > 1 && static_cast<double>(samples - 1) <= 2 * *padding_;
    };
    const bool none = size_ ? leaves_none(size_->x) || leaves_none(size_->y) || leaves_none(size_->z)
                            : !spacing_ && leaves_none(samples_);
    if (none)
      throw Error(ErrorCode::usage, "--padding '" + number(*padding_) +
                                        "' leaves no samples for the mesh; take less, or " +
                                        (size_ ? "a larger --size" : "more with --resolution"));
    return {.samples = *padding_, .least_samples = 0};
  }
  if (!thickness_.in_samples) return padding_for(thickness_.value);
  return spacing_ ? padding_for(thickness_.world(max_norm(*spacing_))) : padding_for_samples(thickness_.value);
}

Grid GridOptions::around(const Box& box) const {
  if (spacing_) return fit_spacing(box, *spacing_, padding());
  if (size_) return fit_size(box, *size_, padding());
  return fit_resolution(box, samples_, padding());
}

std::string grid_line(const GridChoice& choice) {
  const std::string band =
      std::isinf(choice.thickness) ? "full field" : "band of thickness " + number(choice.thickness);
  return "grid " + size_text(choice.grid.size) + ", spacing " + spacing_text(choice.grid.spacing) + ", " + band;
}

Json thickness_json(const Thickness& thickness) {
  if (thickness.infinite()) return nullptr;
  return {{"value", thickness.value}, {"in_samples", thickness.in_samples}};
}

Json GridOptions::parameters() const {
  Json json;
  if (minimum_) {
    json["minimum"] = *minimum_;
    json["speed"] = speed_;
  } else if (spacing_) {
    json["spacing"] = json_point(*spacing_);
  } else if (size_) {
    json["size"] = json_size(*size_);
  } else {
    json["resolution"] = samples_;
  }
  if (bounds_) json["bounds"] = json_box(*bounds_);
  if (padding_) json["padding"] = *padding_;
  json["thickness"] = thickness_json(thickness_);
  return json;
}

GridChoice GridOptions::choose(const Box& mesh) const {
  if (minimum_) {
    if (thickness_.in_samples || thickness_.infinite())
      throw Error(ErrorCode::usage,
                  "--minimum: needs a --thickness in world units, by which it sets the samples; give one without s");
    return {minimum_grid(mesh, thickness_.value, *minimum_, speed_), thickness_.value};
  }
  const Grid grid = around(bounds_.value_or(mesh));
  return {grid, thickness_.world(grid.max_spacing())};
}

std::optional<Size3> GridOptions::known_size() const {
  if (minimum_) return std::nullopt;
  if (bounds_) return around(*bounds_).size;
  return spacing_ ? std::nullopt : size_;
}

namespace {

constexpr const char* kSignGroup = "Sign";
constexpr const char* kNames[] = {"--sign", "--rule", "--invert", "--as-oriented", "--outer", "--strict"};

// Adds all options but --sign and --outer.
void add_details(CLI::App& verb, SignOptions& options) {
  add_parsed(
      verb, {"--rule", "NAME", "inside is where the winding number is positive (default),\nnonzero or odd", kSignGroup},
      [&](S o, S t) { options.rule = parse_winding_rule(o, t); });
  verb.add_flag("--invert", options.invert, "exchange inside and outside, as for a room scanned from inside")
      ->group(kSignGroup);
  verb.add_flag("--as-oriented", options.as_oriented, "take triangles as they are oriented; repair nothing first")
      ->group(kSignGroup);
  verb.add_flag("--strict", options.strict, "fail with exit code 8 where the sign is not certain")->group(kSignGroup);
}

// "shell:T", "auto (default)".
std::string shown_name(const SignMethodInfo& info, SignMethod by_default) {
  return std::string(info.name) + (info.method == SignMethod::shell ? ":T" : "") +
         (info.method == by_default ? " (default)" : "");
}

}  // namespace

std::string sign_names(TakesSign takes, SignMethod by_default) {
  std::vector<std::string> names;
  for (const SignMethodInfo& info : kSignMethods)
    if (takes(info)) names.push_back(shown_name(info, by_default));
  return joined(names);
}

std::string sign_texts(TakesSign takes, SignMethod by_default) {
  std::string text;
  std::string_view last;
  for (const SignMethodInfo& info : kSignMethods) {
    if (!takes(info)) continue;
    const bool same = !last.empty() && last == info.inside;
    if (!text.empty() && !same && !last.empty()) text.append(": ").append(last);
    if (!text.empty()) text += same ? ", " : "; ";
    text += shown_name(info, by_default);
    last = info.inside;
  }
  return last.empty() ? text : text.append(": ").append(last);
}

void add_sign(CLI::App& verb, SignOptions& options, Thickness& shell, const SignHelp& help) {
  add_parsed(verb, {"--sign", "METHOD", wrapped(help.sign, kHelpColumns).c_str(), kSignGroup}, [&](S o, S t) {
    const SignChoice choice = parse_sign(o, t);
    options.method = choice.method;
    shell = choice.shell;
  });
  add_details(verb, options);
  verb.add_flag("--outer", options.outer, wrapped(help.outer, kHelpColumns))->group(kSignGroup);
}

void add_sign(CLI::App& verb, SignOptions& options, Thickness& shell) {
  add_sign(verb, options, shell,
           {"make values inside negative. " + sign_texts(takes_all, SignOptions{}.method) +
                ". `standoff info MESH` says what fits. T is 0.5, or 3s in samples",
            "leave out triangles inside: distances are to the union of all parts (sign winding or auto, closed "
            "meshes)"});
}

void add_sign_to(CLI::App& verb, TakesSign takes, const std::string& help, SignOptions& options) {
  add_parsed(verb, {"--sign", "METHOD", wrapped(help, kHelpColumns).c_str(), kSignGroup}, [&options, takes](S o, S t) {
    std::vector<std::string> names;
    for (const SignMethodInfo& info : kSignMethods)
      if (takes(info)) names.emplace_back(info.name);
    parse_choice(o, t, names);
    options.method = parse_sign(o, t).method;
  });
  add_details(verb, options);
}

bool is_sign_given(const CLI::App& verb) {
  return std::ranges::any_of(kNames, [&](const char* name) {
    const CLI::Option* option = verb.get_option_no_throw(name);
    return option && option->count() > 0;
  });
}

void add_sign_report(Json& json, const SignReport& report) {
  json["sign"] = {{"method", name_of(report.method)}, {"why", report.why}, {"sure", report.sure}};
}

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
  add("--up", "A", kUpHelp, [&options](S o, S t) { options.up = parse_up(o, t); });
  without("--parallel", options.perspective, "parallel rays: no perspective");
  add("--samples", "N", "for each pixel: 1, 2, 4 (default), 8 or 16", [&options](S o, S t) {
    options.samples = 1 << parse_choice(o, t, {"1", "2", "4", "8", "16"});
  });
  add("--background", "NAME", "white (default), dark or transparent", [&options](S o, S t) {
    options.background = static_cast<Background>(parse_choice(o, t, {"white", "dark", "transparent"}));
  });
  without("--no-legend", options.legend, "no legend");
  return all;
}

}  // namespace standoff::cli
