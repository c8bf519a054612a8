// SPDX-License-Identifier: Apache-2.0
// standoff render: a picture of meshes, fields, points and paths.
#include <array>
#include <memory>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/drawing_input.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/spinner.h"
#include "cli/text.h"
#include "cli/usage.h"
#include "standoff/error.h"
#include "standoff/picture.h"

namespace standoff::cli {
namespace {

constexpr const char* kExamples =
    R"(  standoff render bunny.obj --up y                     into bunny.png
  standoff render bunny.obj bunny.vti --up y           cut open at a slice of its field
  standoff render field.vti --layers iso,boxes --iso 2s
  standoff render labyrinth.stl flight.csv --opacity 0.3 --camera top
  standoff render scene:factory -o factory.png --size 1920x1080 --background dark
  standoff render part.stl -o part.png --edges --turntable 36    part-000.png to part-035.png
)";

struct Command {
  DrawingInput input;
  FileOutput output;
  LayerOptions layers;
  PictureOptions options{.width = 1280, .height = 960};
  Colormap colormap = Colormap::automatic;
  int turntable = 0;
  Console console;

  void add_to(CLI::App& verb);
  void run();

 private:
  void add_picture(CLI::App& verb);
  void add_layers(CLI::App& verb);
};

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

void parse_layers(const std::string& option, const std::string& text, LayerOptions& layers) {
  layers.mesh = layers.slice = layers.points = layers.path = false;
  layers.chosen = true;
  bool* const chosen[] = {&layers.mesh,   &layers.slice, &layers.band, &layers.iso,
                          &layers.points, &layers.path,  &layers.boxes};
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    *chosen[parse_choice(option, text.substr(start, end - start),
                         {"mesh", "slice", "band", "iso", "points", "path", "boxes"})] = true;
    start = end + 1;
  }
}

void Command::add_picture(CLI::App& verb) {
  using S = const std::string&;
  const auto add = [&verb](const char* name, const char* value, const char* help, auto set) {
    add_parsed(verb, {name, value, help, "Picture"}, set);
  };
  add("--size", "WxH", "pixels, 16 to 8192 each (default 1280x960)", [this](S o, S t) { parse_pixels(o, t, options); });
  add("--camera", "VIEW",
      "front, back, left, right, top, bottom, iso, or degrees:\nAZIMUTH,ELEVATION[,ZOOM] (default 35,25,1)",
      [this](S o, S t) { parse_camera(o, t, options); });
  add("--up", "A", "the axis that points up: x, y or z (default)", [this](S o, S t) {
    options.up = static_cast<Axis>(parse_choice(o, t, {"x", "y", "z"}));
  });
  verb.add_flag_callback(
          "--parallel", [this] { options.perspective = false; }, "parallel rays: no perspective")
      ->group("Picture");
  add("--turntable", "N", "N pictures from all around: NAME-000.png and so on",
      [this](S o, S t) { turntable = static_cast<int>(parse_count(o, t, 1, 10000)); });
  add("--samples", "N", "for each pixel: 1, 2, 4 (default), 8 or 16", [this](S o, S t) {
    options.samples = 1 << parse_choice(o, t, {"1", "2", "4", "8", "16"});
  });
  add("--background", "NAME", "white (default) or dark", [this](S o, S t) {
    options.background = static_cast<Background>(parse_choice(o, t, {"white", "dark"}));
  });
  verb.add_flag_callback(
          "--no-shadows", [this] { options.shadows = false; },
          "no soft shadows, which take most of the time of small\npictures")
      ->group("Picture");
  verb.add_flag_callback(
          "--no-legend", [this] { options.legend = false; }, "no legend")
      ->group("Picture");
  verb.add_flag("--axes", options.axes, "a triad of the axes in the lower left corner")->group("Picture");
}

void Command::add_layers(CLI::App& verb) {
  using S = const std::string&;
  const auto add = [&verb](const char* name, const char* value, const char* help, auto set) {
    add_parsed(verb, {name, value, help, "Layers"}, set);
  };
  add("--layers", "LIST",
      "which to draw, of mesh, slice, band, iso, points, path,\nboxes (default: mesh, slice, points and path; of a "
      "signed\nfield alone slice and iso)",
      [this](S o, S t) { parse_layers(o, t, layers); });
  add("--colormap", "NAME", "for numbers: auto (default), diverging, viridis or thesis,\nas in standoff slice",
      [this](S o, S t) {
        constexpr Colormap maps[] = {Colormap::automatic, Colormap::diverging, Colormap::viridis, Colormap::thesis};
        colormap = maps[parse_choice(o, t, {"auto", "diverging", "viridis", "thesis"})];
      });
  add("--axis", "A", "the axis slices are perpendicular to (default: of the plane\nthat shows the most)",
      [this](S o, S t) {
        layers.slice_axis = static_cast<Axis>(parse_choice(o, t, {"x", "y", "z"}));
      });
  add("--at", "F", "where slices lie along the axis, from 0 to 1", [this](S o, S t) {
    const double at = parse_number(o, t);
    if (!(at >= 0 && at <= 1)) throw Error(ErrorCode::usage, o + " '" + t + "': give a number from 0 to 1");
    layers.slice_at = at;
  });
  verb.add_flag_callback(
          "--whole", [this] { layers.cuts = false; }, "do not cut meshes open where slices are")
      ->group("Layers");
  add("--iso", "D", "the value on isosurfaces: world units (0.5) or samples\n(2s)", [this](S o, S t) {
    const bool in_samples = t.ends_with('s');
    layers.iso_at = Thickness{parse_number(o, in_samples ? t.substr(0, t.size() - 1) : t), in_samples};
  });
  add("--within", "D", "only samples of the band nearer than this (default: the\nband, of a full field 2s)",
      [this](S o, S t) { layers.within = parse_thickness(o, t); });
  add("--opacity", "F", "of meshes and isosurfaces, from 0 to 1 (default)",
      [this](S o, S t) { layers.opacity = parse_not_negative(o, t, 1); });
  verb.add_flag("--flat", layers.flat, "flat shading: each triangle shows")->group("Layers");
  verb.add_flag("--edges", layers.edges, "lines along sharp and open edges")->group("Layers");
  add("--radius", "R", "of points and paths, world units (default: some pixels)",
      [this](S o, S t) { layers.radius = parse_positive(o, t); });
}

void Command::add_to(CLI::App& verb) {
  input.add_to(verb);
  output.add_to(verb, "PNG", "the picture (default: the first input's name with\n.png, here)");
  add_picture(verb);
  add_layers(verb);
  add_threads(verb, "Work", options.threads);
  console.add_to(verb, Console::kMessages | Console::kJson);
}

void Command::run() {
  if (!output.given()) {
    MeshInput first;
    first.set_name(input.names().front());
    output.set_path(first.stem() + ".png");
  }
  input.check();
  output.check({{"png", "PNG picture", false, true}});
  Drawing drawing = input.read(layers, console);
  drawing.colormap = colormap;
  options.memory_limit = input.memory_limit();
  const std::string shown = output.path().string();
  with_spinner(console, "drawing " + shown, [&] {
    if (turntable > 0)
      write_turntable(output.path(), drawing, turntable, options, output.existing());
    else
      write_picture(output.path(), drawing, options, output.existing());
  });
  const std::string size = std::to_string(options.width) + " x " + std::to_string(options.height) + " pixels";
  console.say(turntable > 0 ? std::to_string(turntable) + " pictures beside " + shown + ", " + size
                            : shown + ": " + size);
  if (!console.json()) return;
  Json json = json_answer("render");
  for (const std::string& name : input.names()) json["inputs"].push_back({{"file", name}});
  json["width"] = options.width;
  json["height"] = options.height;
  json["pictures"] = turntable > 0 ? turntable : 1;
  if (turntable > 0) {
    json["output"] = nullptr;
    print(json);
    return;
  }
  json["output"] = json_output(output.path());
  print(json, output.path());
}

}  // namespace

void add_render(CLI::App& program) {
  auto* verb = add_verb(program, "render", "draw meshes, fields, points and paths as a picture", kExamples);
  const auto command = std::make_shared<Command>();
  command->add_to(*verb);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
