// SPDX-License-Identifier: Apache-2.0
// standoff render: a picture of meshes, fields, points and paths.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "files/atomic_file.h"
#include "io/points/points.h"
#include "standoff/error.h"
#include "standoff/io.h"
#include "standoff/picture.h"
#include "standoff/slice.h"
#include "standoff/surface.h"

namespace standoff::cli {
namespace {

/// Which layers are drawn, and how.
struct LayerOptions {
  bool mesh = true, slice = true, band = false, iso = false, points = true, path = true, boxes = false;
  bool chosen = false;             ///< false: what suits the inputs
  std::optional<Axis> slice_axis;  ///< default: of the plane that shows the most
  std::optional<double> slice_at;  ///< from 0 to 1 along the axis; default: where the plane shows the most
  bool cuts = true;
  std::optional<Thickness> iso_at;  ///< default: 0 if the field has a sign, else two samples
  std::optional<Thickness> within;  ///< of the samples that are drawn; default: the band, of a full field 2 samples
  double opacity = 1;
  bool flat = false, edges = false;
  double radius = 0;  ///< of points and paths, world units; 0: a few pixels
};

/// Files that were read, and the drawing that views them.
class DrawingInput {
 public:
  /// Adds the positional arguments and --memory-limit.
  void add_to(CLI::App& verb);
  const std::vector<std::string>& names() const { return names_; }
  std::int64_t memory_limit() const { return field_argument_.memory_limit(); }

  /// Checks the names before anything is read. Errors: usage, input.
  void check() const;
  /// Reads all files and makes the layers. Errors: those of reading; usage when a layer is asked for of which there is
  /// no input.
  const Drawing& read(const LayerOptions& layers, const Console& console);

 private:
  enum class Kind { mesh, field, points, path };
  struct Polyline {
    std::vector<Vec3> points;
    std::vector<std::size_t> starts;
    std::vector<double> values;
  };

  static Kind kind_of_input(const std::string& name);
  void read_points(const std::string& name, bool is_path);
  void check_layers(const LayerOptions& layers) const;
  void add_field_layers(const LayerOptions& layers, const Console& console);
  void color_by_field(Polyline& line) const;

  std::vector<std::string> names_;
  FieldArgument field_argument_;
  std::vector<MeshReadResult> meshes_;
  std::vector<Mesh> surfaces_;
  std::vector<std::vector<Vec3>> normals_;
  std::vector<DistanceField> fields_;
  std::vector<Polyline> points_, paths_;
  Drawing drawing_;
};

std::string head_of(const std::string& name) {
  // A pipe can be read only once.
  if (std::error_code ignored; !std::filesystem::is_regular_file(name, ignored)) return "";
  std::string head(4096, '\0');
  std::ifstream file(name, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return head;
}

double along(Axis axis, const Size3& size) {
  return static_cast<double>(axis == Axis::x ? size.x : axis == Axis::y ? size.y : size.z);
}

void DrawingInput::add_to(CLI::App& verb) {
  verb.add_option("INPUT", names_,
                  "what to draw, all in one space: meshes, scene:NAME[:TRIANGLES],\nfields, points (.csv, .txt, .xyz, "
                  ".npy, .ply), paths that standoff fly wrote")
      ->required();
  field_argument_.add_to(verb, "each field that is read, and drawing");
}

DrawingInput::Kind DrawingInput::kind_of_input(const std::string& name) {
  if (name.starts_with("scene:")) return Kind::mesh;
  const FileKind kind = kind_of(name);
  if (kind == FileKind::field) return Kind::field;
  if (kind != FileKind::mesh) return Kind::mesh;  // which says what is wrong with it
  std::string extension = std::filesystem::path(name).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  const std::string head = head_of(name);
  if (extension == ".ply" && head.find("element face") != std::string::npos) return Kind::mesh;
  std::error_code ignored;
  const bool pipe = std::filesystem::is_fifo(name, ignored);
  if (pipe && extension == ".ply") return Kind::mesh;
  for (const char* of_points : {".ply", ".csv", ".tsv", ".txt", ".xyz", ".npy"})
    if (extension == of_points) return is_path(head) ? Kind::path : Kind::points;
  return Kind::mesh;
}

void DrawingInput::check() const {
  for (const std::string& name : names_) check_input(name);
}

void DrawingInput::read_points(const std::string& name, bool is_path) {
  Polyline line;
  const auto reader = open_points(name, InvalidPoints::mark);
  std::vector<Vec3> block(1 << 14);
  while (const std::size_t count = reader->read(block)) {
    line.points.insert(line.points.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(count));
    const std::span<const double> distances = reader->distances();
    line.values.insert(line.values.end(), distances.begin(), distances.end());
  }
  if (is_path) line.starts = path_starts(name, read_text(name), line.points.size());
  (is_path ? paths_ : points_).push_back(std::move(line));
}

void DrawingInput::color_by_field(Polyline& line) const {
  if (fields_.empty() || !line.values.empty()) return;
  line.values.resize(line.points.size());
  fields_.front().interpolate(line.points, line.values);  // NaN, which is pink, outside the grid
}

void DrawingInput::check_layers(const LayerOptions& layers) const {
  if (!layers.chosen) return;
  const auto expect = [](bool wanted, const char* layer, bool there, const char* what) {
    if (wanted && !there) throw Error(ErrorCode::usage, std::string("--layers ") + layer + ": there is " + what);
  };
  const char* const no_field = "no field among the inputs; give one, which standoff compute makes";
  expect(layers.slice, "slice", !fields_.empty(), no_field);
  expect(layers.band, "band", !fields_.empty(), no_field);
  expect(layers.iso, "iso", !fields_.empty(), no_field);
  expect(layers.mesh, "mesh", !meshes_.empty(), "no mesh among the inputs; give one");
  expect(layers.points, "points", !points_.empty(), "no file of points among the inputs; give a .csv, .npy or .ply");
  expect(layers.path, "path", !paths_.empty(), "no path among the inputs; give one that standoff fly --path wrote");
  expect(layers.boxes, "boxes", !meshes_.empty() || !fields_.empty(),
         "no mesh and no field among the inputs; give one");
}

void DrawingInput::add_field_layers(const LayerOptions& layers, const Console& console) {
  const bool alone = meshes_.empty() && !layers.chosen;
  for (const DistanceField& field : fields_) {
    const bool has_sign = field.has_sign();
    if (layers.slice) {
      SliceOptions wanted;
      wanted.axis = layers.slice_axis;
      wanted.at = layers.slice_at;
      const SlicePlane plane = slice_plane(field, wanted);
      const double last = along(plane.axis, field.grid().size) - 1;
      drawing_.slices.push_back({.field = &field,
                                 .axis = plane.axis,
                                 .at = last > 0 ? static_cast<double>(plane.index) / last : 0.5,
                                 .cuts = layers.cuts});
    }
    const double spacing = field.grid().max_spacing();
    const bool is_full = field.thickness() > 0.5 * field.grid().bounds().longest_side();
    if (layers.band)
      drawing_.bands.push_back(
          {.field = &field,
           .within = layers.within ? layers.within->world(spacing) : (is_full ? 2 * spacing : field.thickness())});
    if (layers.boxes) drawing_.boxes.push_back({.box = field.grid().bounds()});
    if (!layers.iso && !(alone && has_sign)) continue;
    SurfaceOptions options{.at = layers.iso_at ? layers.iso_at->world(spacing) : (has_sign ? 0 : 2 * spacing),
                           .memory_limit = memory_limit()};
    SurfaceResult made = surface(field, options);
    if (made.report.capped > 0)
      console.warn("the isosurface at " + number(options.at) +
                   " is cut off at the grid's border; take a lower --iso, or a field with more --padding");
    surfaces_.push_back(std::move(made.mesh));
    normals_.emplace_back(surfaces_.back().vertices.size());
    if (surfaces_.back().triangles.empty() && layers.chosen)
      throw Error(ErrorCode::usage, "--iso " + number(options.at) +
                                        ": the field has no surface at this value; take one between its least and its "
                                        "greatest, which standoff info tells");
    field.gradient(surfaces_.back().vertices, normals_.back(), {}, Outside::border);
    for (Vec3& n : normals_.back())
      if (const double size = length(n); size > 0) n = n * (1 / size);
  }
}

const Drawing& DrawingInput::read(const LayerOptions& layers, const Console& console) {
  for (const std::string& name : names_) {
    const Kind kind = kind_of_input(name);
    if (kind == Kind::field) {
      fields_.push_back(field_argument_.read(name, console));
      continue;
    }
    with_spinner(console, "reading " + name, [&] {
      if (kind != Kind::mesh) return read_points(name, kind == Kind::path);
      MeshInput input;
      input.set_name(name);
      meshes_.push_back(input.read_with_report());
    });
  }
  check_layers(layers);
  add_field_layers(layers, console);
  const Shading shading = layers.flat ? Shading::flat : Shading::smooth;
  if (layers.mesh)
    for (std::size_t n = 0; n < meshes_.size(); ++n) {
      MeshLayer layer{.mesh = meshes_[n].mesh,
                      .opacity = layers.opacity,
                      .shading = shading,
                      .edges = layers.edges,
                      .up = meshes_[n].report.up};
      if (n > 0) layer.color = kBodyColors[(n - 1) % kBodyColors.size()];
      drawing_.meshes.push_back(layer);
    }
  for (std::size_t n = 0; n < surfaces_.size(); ++n)
    if (!surfaces_[n].triangles.empty())
      drawing_.meshes.push_back({.mesh = surfaces_[n],
                                 .opacity = layers.opacity,
                                 .shading = shading,
                                 .edges = layers.edges,
                                 .normals = layers.flat ? std::span<const Vec3>() : normals_[n]});
  if (layers.boxes)
    for (const auto& [mesh, read] : meshes_) drawing_.boxes.push_back({.box = bounds(mesh)});
  for (Polyline& line : points_) {
    if (!layers.points) break;
    color_by_field(line);
    drawing_.points.push_back({.points = line.points, .radius = layers.radius, .values = line.values});
  }
  for (Polyline& line : paths_) {
    if (!layers.path) break;
    color_by_field(line);
    drawing_.paths.push_back(
        {.points = line.points, .starts = line.starts, .radius = layers.radius, .values = line.values});
  }
  return drawing_;
}

constexpr const char* kRenderExamples =
    R"(  standoff render bunny.obj                            into bunny.png
  standoff render bunny.obj bunny.vti                  cut open at a slice of its field
  standoff render field.vti --layers iso,boxes --iso 2s
  standoff render labyrinth.stl flight.csv --opacity 0.3 --camera top
  standoff render scene:factory -o factory.png --size 1920x1080 --background dark
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
  add_command<RenderCommand>(program, "render", "draw meshes, fields, points and paths as a picture", kRenderExamples);
}

}  // namespace standoff::cli
