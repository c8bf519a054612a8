// SPDX-License-Identifier: Apache-2.0
// Everything that a drawing shows, made into triangles once, and seen from any number of directions.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/camera.h"
#include "render/image.h"
#include "render/legend.h"
#include "render/occlusion.h"
#include "render/part.h"
#include "render/ramp.h"
#include "render/theme.h"
#include "standoff/picture.h"

namespace standoff {

class Stage {
 public:
  /// Errors: as write_picture.
  Stage(const Drawing& drawing, const PictureOptions& options);

  /// What is seen from a direction, on the plane of the picture.
  struct Extent {
    double least_u = std::numeric_limits<double>::infinity(), least_v = least_u;
    double most_u = -least_u, most_v = -least_u;

    void include(const Extent& other);
  };
  Extent extent(const Camera& camera) const;
  /// The picture in which `extent` fills the room beside the legend.
  Image draw(const Camera& camera, const Extent& extent) const;

 private:
  void add_numbers(const Drawing& drawing);
  Framing::Room room() const;
  Float3 up() const;

  PictureOptions options_;
  std::unique_ptr<UnitSpace> space_;
  std::vector<DrawnPart> parts_;
  std::unique_ptr<Occlusion> occlusion_;
  std::optional<Legend> legend_;
  double words_ = 1;  // the scale of words
  Theme theme_;
  Ramp ramp_;
  double contour_step_ = 0;
};

/// As write_picture says, before it becomes a file.
Image draw_picture(const Drawing& drawing, const PictureOptions& options);
/// As write_mesh_png says.
Image draw_mesh(MeshView mesh, const PictureOptions& options);

}  // namespace standoff
