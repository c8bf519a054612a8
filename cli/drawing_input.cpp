// SPDX-License-Identifier: Apache-2.0
#include "cli/drawing_input.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>

#include "cli/files.h"
#include "cli/spinner.h"
#include "files/text_file.h"
#include "io/points/point_reader.h"
#include "standoff/error.h"
#include "standoff/io.h"
#include "standoff/slice.h"
#include "standoff/surface.h"

namespace standoff::cli {
namespace {

std::string head_of(const std::string& name) {
  std::string head(4096, '\0');
  std::ifstream file(name, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return head;
}

bool is_signed(const DistanceField& field) {
  return !field.provenance().sign.empty() || std::ranges::count(field.slots(), DistanceField::kInside) > 0 ||
         std::ranges::any_of(field.tile_values(), [](float value) { return value < 0; });
}

double along(Axis axis, const Size3& size) {
  return static_cast<double>(axis == Axis::x ? size.x : axis == Axis::y ? size.y : size.z);
}

// Calls use(line) for each line of a text.
template <class Use>
void for_lines(std::string_view text, const Use& use) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    use(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

// Where the lines of a path begin: in a table where its first column changes, in a PLY file where no edge leads on.
std::vector<std::size_t> starts_of(const std::string& text, std::size_t points) {
  std::vector<std::size_t> starts;
  if (text.starts_with("ply")) {
    std::vector<char> joined(points, 0);  // to the point before
    std::size_t row = 0, header_end = text.find("end_header");
    header_end = header_end == std::string::npos ? text.size() : std::min(text.find('\n', header_end), text.size());
    for_lines(std::string_view(text).substr(header_end), [&](std::string_view line) {
      if (line.empty()) return;
      if (row++ < points) return;
      std::array<std::size_t, 2> ends{};
      const char *at = line.data(), *const end = line.data() + line.size();
      at = std::from_chars(at, end, ends[0]).ptr;
      while (at != end && *at == ' ') ++at;
      std::from_chars(at, end, ends[1]);
      if (ends[1] == ends[0] + 1 && ends[1] < points) joined[ends[1]] = 1;
    });
    for (std::size_t n = 0; n < points; ++n)
      if (!joined[n]) starts.push_back(n);
    return starts;
  }
  std::size_t row = 0;
  std::string_view before;
  bool header = true;
  for_lines(text, [&](std::string_view line) {
    if (std::exchange(header, false) || line.empty()) return;
    const std::string_view flier = line.substr(0, line.find(','));
    if (row == 0 || flier != before) starts.push_back(row);
    before = flier;
    ++row;
  });
  return starts;
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
  if (extension == ".ply") {
    const std::string head = head_of(name);
    if (head.find("element face") != std::string::npos) return Kind::mesh;
    return head.find("element edge") != std::string::npos ? Kind::path : Kind::points;
  }
  for (const char* table : {".csv", ".tsv", ".txt", ".xyz", ".npy"})
    if (extension == table) return head_of(name).starts_with("flier,step,") ? Kind::path : Kind::points;
  return Kind::mesh;
}

void DrawingInput::check() const {
  for (const std::string& name : names_) check_input(name);
}

void DrawingInput::read_points(const std::string& name, bool is_path) {
  Polyline line;
  const auto reader = open_points(name, InvalidPoints::reject);
  std::vector<Vec3> block(1 << 14);
  while (const std::size_t count = reader->read(block))
    line.points.insert(line.points.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(count));
  if (is_path) line.starts = starts_of(read_text(name), line.points.size());
  (is_path ? paths_ : points_).push_back(std::move(line));
}

void DrawingInput::color_by_field(Polyline& line) const {
  if (fields_.empty()) return;
  line.values.resize(line.points.size());
  fields_.front().interpolate(line.points, line.values);
}

void DrawingInput::add_field_layers(const LayerOptions& layers) {
  const bool alone = meshes_.empty() && !layers.chosen;
  for (const DistanceField& field : fields_) {
    const bool has_sign = is_signed(field);
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
    options.at = layers.iso_at ? layers.iso_at->world(spacing) : (has_sign ? 0 : 2 * spacing);
    surfaces_.push_back(isosurface(field, options).mesh);
    normals_.emplace_back(surfaces_.back().vertices.size());
    field.gradient(surfaces_.back().vertices, normals_.back());
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
