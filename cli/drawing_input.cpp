// SPDX-License-Identifier: Apache-2.0
#include "cli/drawing_input.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "cli/files.h"
#include "cli/spinner.h"
#include "cli/text.h"
#include "files/atomic_file.h"
#include "io/points/path_starts.h"
#include "io/points/point_reader.h"
#include "standoff/error.h"
#include "standoff/io.h"
#include "standoff/slice.h"
#include "standoff/surface.h"

namespace standoff::cli {
namespace {

std::string head_of(const std::string& name) {
  // A pipe can be looked at once.
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

}  // namespace

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
  while (const std::size_t count = reader->read(block))
    line.points.insert(line.points.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(count));
  if (is_path) line.starts = path_starts(name, read_text(name), line.points.size());
  (is_path ? paths_ : points_).push_back(std::move(line));
}

void DrawingInput::color_by_field(Polyline& line) const {
  if (fields_.empty()) return;
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

void DrawingInput::add_field_layers(const LayerOptions& layers) {
  const bool alone = meshes_.empty() && !layers.chosen;
  for (const DistanceField& field : fields_) {
    const bool has_sign = field.has_sign();
    // Then there is something to see through the slice.
    const bool shows_solid = (layers.mesh && !meshes_.empty()) || layers.iso || (alone && has_sign);
    if (layers.slice) {
      SliceOptions wanted;
      wanted.axis = layers.slice_axis;
      wanted.at = layers.slice_at;
      const SlicePlane plane = slice_plane(field, wanted);
      const double last = along(plane.axis, field.grid().size) - 1;
      drawing_.slices.push_back({.field = &field,
                                 .axis = plane.axis,
                                 .at = last > 0 ? static_cast<double>(plane.index) / last : 0.5,
                                 .cuts = layers.cuts,
                                 .outside_opacity = shows_solid && has_sign ? 0.6 : 1});
    }
    const double spacing = field.grid().max_spacing();
    const bool is_full = field.thickness() > 0.5 * field.grid().bounds().longest_side();
    if (layers.band)
      drawing_.bands.push_back(
          {.field = &field,
           .within = layers.within ? layers.within->world(spacing) : (is_full ? 2 * spacing : field.thickness())});
    if (layers.boxes) drawing_.boxes.push_back({.box = field.grid().bounds()});
    if (!layers.iso && !(alone && has_sign)) continue;
    IsoOptions options;
    options.memory_limit = memory_limit();
    options.at = layers.iso_at ? layers.iso_at->world(spacing) : (has_sign ? 0 : 2 * spacing);
    surfaces_.push_back(isosurface(field, options).mesh);
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
      meshes_.push_back(input.read());
    });
  }
  check_layers(layers);
  add_field_layers(layers);
  const Shading shading = layers.flat ? Shading::flat : Shading::smooth;
  if (layers.mesh)
    for (const Mesh& mesh : meshes_)
      drawing_.meshes.push_back({.mesh = mesh, .opacity = layers.opacity, .shading = shading, .edges = layers.edges});
  for (std::size_t n = 0; n < surfaces_.size(); ++n)
    if (!surfaces_[n].triangles.empty())
      drawing_.meshes.push_back({.mesh = surfaces_[n],
                                 .opacity = layers.opacity,
                                 .shading = shading,
                                 .edges = layers.edges,
                                 .normals = layers.flat ? std::span<const Vec3>() : normals_[n]});
  if (layers.boxes)
    for (const Mesh& mesh : meshes_) drawing_.boxes.push_back({.box = bounds(mesh)});
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

}  // namespace standoff::cli
