// SPDX-License-Identifier: Apache-2.0
// Everything that a drawing shows, made into triangles once, and seen from any number of directions.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/camera.h"
#include "render/image.h"
#include "render/light.h"
#include "render/part.h"
#include "render/scales.h"
#include "standoff/picture.h"

namespace standoff {

class Stage {
 public:
  /// Errors: as write_picture.
  Stage(const Drawing& drawing, const PictureOptions& options) : Stage(drawing, drawing, options) {}
  /// The same for the part of a drawing that stands, where something moves beside it: space and colors are those of
  /// `whole`, which says how far places and numbers reach.
  Stage(const Drawing& standing, const Drawing& whole, const PictureOptions& options);

  /// Shows the meshes, points and paths of a drawing beside what stands, in place of those shown before. They cast no
  /// shadows on what stands.
  void move(const Drawing& moving);

  /// What is seen from a direction, on the plane of the picture.
  struct Extent {
    double least_u = std::numeric_limits<double>::infinity(), least_v = least_u;
    double most_u = -least_u, most_v = -least_u;

    void include(const Extent& other);
  };
  Extent extent(const Camera& camera) const;
  /// The picture in which `extent` fills the room beside the legend.
  Image draw(const Camera& camera, const Extent& extent) const;
  /// Draws what stands, for all later calls of draw(), whose camera and extent must be these: they then draw only the
  /// tiles in which something moves.
  void keep(const Camera& camera, const Extent& extent);

 private:
  Image draw_on(Color paper, const Camera& camera, const Extent& extent) const;
  Image draw_parts(const Camera& camera, const Framing& framing, Color paper) const;
  Framing framing(const Extent& extent) const;
  void add_numbers(const Drawing& drawing);
  DrawnPart made_of(const MeshLayer& layer, std::vector<char> unused) const;
  Framing::Room room() const;
  Float3 up() const;
  std::size_t pixels() const {
    return static_cast<std::size_t>(options_.width) * static_cast<std::size_t>(options_.height);
  }

  PictureOptions options_;
  std::unique_ptr<UnitSpace> space_;
  std::vector<DrawnPart> parts_;
  std::size_t standing_ = 0;   // of the parts; those after them move
  float pixel_ = 0;            // about its width in the unit space
  std::optional<Image> kept_;  // what stands, without legend and axes
  std::unique_ptr<Occlusion> occlusion_;
  std::optional<Legend> legend_;
  double words_ = 1;  // the scale of words
  Theme theme_;
  Ramp ramp_;
  double contour_step_ = 0;
};

/// The options with the axis that points up, whether it was given or not. Errors: input (mesh).
PictureOptions upright(const Drawing& drawing, const PictureOptions& options);
/// As write_picture says, before it becomes a file.
Image draw_picture(const Drawing& drawing, const PictureOptions& options);
/// As write_mesh_png says.
Image draw_mesh(MeshView mesh, const PictureOptions& options);

}  // namespace standoff
