// SPDX-License-Identifier: Apache-2.0
// standoff slice: a picture of a plane of a field.
#include "standoff/slice.h"

#include <limits>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "standoff/field_slices.h"
#include "standoff/zarr.h"

namespace standoff::cli {
namespace {

constexpr const char* kSliceExamples =
    R"(  standoff slice bunny.vti                             the plane that shows the most, into bunny.png
  standoff slice bunny.vti -o side.png --axis x --at 0.3
  standoff slice bunny.vti -o floor.png --axis z --index 0      the first plane of samples
  standoff slice bunny.vti -o dark.png --background dark --title Bunny --length-unit mm
  standoff slice bunny.vti -o red.png --colormap thesis
)";

struct SliceCommand {
  std::string field;
  FieldArgument input;
  FileOutput output;
  SliceOptions options;
  std::optional<std::string> title;
  bool no_contours = false;
  Console console;

  void add_to(CLI::App& verb);
  void run();

 private:
  DistanceField read(SlicePlane& plane);
};

void SliceCommand::add_to(CLI::App& verb) {
  verb.add_option("FIELD", field, "a field file (" + extensions(field_formats(), false) + ")")->required();
  output.add_to(verb, "PNG", "the picture (default: the field's name with .png, here)");
  const auto add = [&verb](const char* name, const char* value, const char* help, auto set) {
    return add_parsed(verb, {name, value, help, "Picture"}, set);
  };
  add("--axis", "A", "the axis the plane is perpendicular to: x, y or z\n(default: of the plane that shows the most)",
      [this](S o, S t) { options.axis = parse_axis(o, t); });
  auto* at = add("--at", "F", "where along the axis, from 0 to 1 (default: where the plane\nshows the most)",
                 [this](S o, S t) { options.at = parse_share(o, t); });
  add("--index", "N", "which sample along the axis, from 0, in place of --at", [this](S o, S t) {
    options.index = parse_count(o, t, 0, std::numeric_limits<std::int64_t>::max());
  })->excludes(at);
  add("--pixels", "N", "enlarge the longer side to at least this (default 512)",
      [this](S o, S t) { options.pixels = static_cast<int>(parse_count(o, t, 1, 8192)); });
  add("--colormap", "NAME",
      "auto (default): diverging if the field has a sign, else viridis;\ndiverging: blue inside, white at 0, red "
      "outside; viridis: dark\n"
      "blue to yellow; thesis: red, green, blue as in 2008",
      [this](S o, S t) { options.colormap = parse_colormap(o, t); });
  add("--interpolation", "NAME",
      "auto (default): squares for samples of 12 pixels and more,\nelse linear; nearest: squares; linear",
      [this](S o, S t) {
        options.interpolation = static_cast<Interpolation>(parse_choice(o, t, {"auto", "nearest", "linear"}));
      });
  add("--background", "NAME", "white (default) or dark", [this](S o, S t) {
    options.background = static_cast<Background>(parse_choice(o, t, {"white", "dark"}));
  });
  verb.add_option("--title", title, "words above the picture (default: the field's name)")
      ->type_name("TEXT")
      ->group("Picture");
  verb.add_option("--length-unit", options.unit, "the unit of lengths, beside the scales")
      ->type_name("TEXT")
      ->group("Picture");
  verb.add_option("--legend", options.legend, "what the numbers are (default: distance)")
      ->type_name("TEXT")
      ->group("Picture");
  verb.add_flag("--no-contours", no_contours, "no lines at the legend's numbers")->group("Picture");
  verb.add_flag("--bare", options.bare, "the plane alone: no words, legend, scales or margins")->group("Picture");
  input.add_to(verb);
  console.add_to(verb, Console::kMessages | Console::kJson);
}

// Reads what the picture needs, sets its plane, and says which it is. Where the options name the plane, that is the
// plane alone: of a store, and of files of which slices can be read.
DistanceField SliceCommand::read(SlicePlane& plane) {
  const auto draw = [&](std::int64_t index) {
    options.axis = plane.axis;
    options.index = index;
  };
  const bool sliced = is_store(field) || (options.axis == Axis::z && FieldSlices::can_open(field));
  if (!sliced || !options.axis || !(options.at || options.index)) {
    DistanceField whole = input.read(field, console);
    plane = slice_plane(whole, options);
    draw(plane.index);
    return whole;
  }
  const std::optional<ZarrStore> store = is_store(field) ? std::optional(input.open_store(field)) : std::nullopt;
  const FieldSlices slices = store ? FieldSlices(*store) : input.open_slices(field);
  const Grid& grid = slices.grid();
  const auto axis = static_cast<std::size_t>(*options.axis);
  Grid line = grid;  // has the planes that the options may name, and hardly a sample beside
  line.size = {1, 1, 1};
  line.size[axis] = grid.size[axis];
  plane = slice_plane(DistanceField(line, 1), options);
  Size3 first{}, size = grid.size;
  first[axis] = plane.index;
  size[axis] = 1;
  draw(0);
  options.part = {plane.index, grid.size[axis]};
  return with_spinner(console, "reading " + field, [&] {
    return store ? store->read(first, size, input.reading()) : slices.read(plane.index, 1, input.reading());
  });
}

void SliceCommand::run() {
  if (!output.given()) output.set_path(std::filesystem::path(field).stem().string() + ".png");
  check_input(field);
  output.check({{"png", "PNG picture", false, true}});
  output.check_differs(field);
  options.title = title.value_or(std::filesystem::path(field).filename().string());
  options.contours = !no_contours;
  SlicePlane plane;
  const DistanceField loaded = read(plane);
  write_slice_png(output.path(), loaded, options, output.existing());
  const std::string axis(1, name_of(plane.axis));
  console.say(output.path().string() + ": the plane of " + field + " at " + axis + " = " + number(plane.position) +
              ", sample " + std::to_string(plane.index));
  if (!console.json()) return;
  Json json = json_answer("slice");
  json["field"] = {{"file", field}};
  json["axis"] = axis;
  json["index"] = plane.index;
  json["position"] = plane.position;
  json["output"] = json_output(output.path());
  print(json, output.path());
}

}  // namespace

void add_slice(CLI::App& program) {
  add_command<SliceCommand>(program, "slice", "draw a plane of a field as a picture", kSliceExamples);
}

}  // namespace standoff::cli
