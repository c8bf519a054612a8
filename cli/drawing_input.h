// SPDX-License-Identifier: Apache-2.0
// What standoff render draws: files, and the layers that become of them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/console.h"
#include "cli/field_argument.h"
#include "cli/parse.h"
#include "standoff/picture.h"

namespace standoff::cli {

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

  /// Tells before anything is read what is wrong with names. Errors: usage, input.
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
  void add_field_layers(const LayerOptions& layers);
  void color_by_field(Polyline& line) const;

  std::vector<std::string> names_;
  FieldArgument field_argument_;
  std::vector<Mesh> meshes_, surfaces_;
  std::vector<std::vector<Vec3>> normals_;
  std::vector<DistanceField> fields_;
  std::vector<Polyline> points_, paths_;
  Drawing drawing_;
};

}  // namespace standoff::cli
