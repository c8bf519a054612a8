// SPDX-License-Identifier: Apache-2.0
// standoff render: a picture of meshes, fields, points and paths.
#include <memory>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/drawing_input.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/picture_options.h"
#include "cli/spinner.h"
#include "cli/text.h"
#include "cli/usage.h"
#include "standoff/error.h"
#include "standoff/picture.h"

namespace standoff::cli {
namespace {

constexpr const char* kRenderExamples =
    R"(  standoff render bunny.obj --up y                     into bunny.png
  standoff render bunny.obj bunny.vti --up y           cut open at a slice of its field
  standoff render field.vti --layers iso,boxes --iso 2s
  standoff render labyrinth.stl flight.csv --opacity 0.3 --camera top
  standoff render scene:factory --up y -o factory.png --size 1920x1080 --background dark
  standoff render part.stl -o part.png --edges --turntable 36    part-000.png to part-035.png
)";

struct RenderCommand {
  DrawingInput input;
  FileOutput output;
  LayerOptions layers;
  PictureOptions options;
  Colormap colormap = Colormap::automatic;
  int turntable = 0;
  Console console;

  void add_to(CLI::App& verb);
  void run();

 private:
  void add_picture(CLI::App& verb);
  void add_layers(CLI::App& verb);
};

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

void RenderCommand::add_picture(CLI::App& verb) {
  add_picture_options(verb, options);
  add_parsed(verb, {"--turntable", "N", "N pictures from all around: NAME-000.png and so on", kPictureGroup},
             [this](S o, S t) { turntable = static_cast<int>(parse_count(o, t, 1, 720)); });
  verb.add_flag_callback(
          "--no-shadows", [this] { options.shadows = false; },
          "no soft shadows, which take most of the time of small\npictures")
      ->group(kPictureGroup);
  verb.add_flag("--axes", options.axes, "a triad of the axes in the lower left corner")->group(kPictureGroup);
}

void RenderCommand::add_layers(CLI::App& verb) {
  const auto add = [&verb](const char* name, const char* value, const char* help, auto set) {
    add_parsed(verb, {name, value, help, "Layers"}, set);
  };
  add("--layers", "LIST",
      "which to draw, of mesh, slice, band, iso, points, path,\nboxes (default: mesh, slice, points and path; of a "
      "signed\nfield alone slice and iso)",
      [this](S o, S t) { parse_layers(o, t, layers); });
  add("--colormap", "NAME", "for numbers: auto (default), diverging, viridis or thesis,\nas in standoff slice",
      [this](S o, S t) { colormap = parse_colormap(o, t); });
  add("--axis", "A", "the axis slices are perpendicular to (default: of the plane\nthat shows the most)",
      [this](S o, S t) { layers.slice_axis = parse_axis(o, t); });
  add("--at", "F", "where slices lie along the axis, from 0 to 1 (default: where\nthe plane shows the most)",
      [this](S o, S t) { layers.slice_at = parse_share(o, t); });
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

void RenderCommand::add_to(CLI::App& verb) {
  input.add_to(verb);
  output.add_to(verb, "PNG", "the picture (default: the first input's name with\n.png, here)");
  add_picture(verb);
  add_layers(verb);
  add_threads(verb, "Work", options.threads);
  console.add_to(verb, Console::kMessages | Console::kJson);
}

void RenderCommand::run() {
  if (!output.given()) {
    MeshInput first;
    first.set_name(input.names().front());
    output.set_path(first.stem() + ".png");
  }
  input.check();
  const std::vector<FileFormat> formats{{"png", "PNG picture", false, true}};
  output.check_name(formats);
  for (int n = 0; n < std::max(turntable, 1); ++n) {
    const FileOutput one = turntable > 0 ? output.beside(turntable_file(output.path(), n)) : output;
    one.check(formats);
    for (const std::string& name : input.names()) one.check_differs(name);
  }
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
  console.say(turntable > 0 ? turntable_file(shown, 0).string() + " to " +
                                  turntable_file(shown, turntable - 1).filename().string() + ": " + size + " each"
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
  auto* verb = add_verb(program, "render", "draw meshes, fields, points and paths as a picture", kRenderExamples);
  const auto command = std::make_shared<RenderCommand>();
  command->add_to(*verb);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
