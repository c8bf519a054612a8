// SPDX-License-Identifier: Apache-2.0
// What a point of a triangle looks like.
#pragma once

#include "render/bins.h"
#include "render/camera.h"
#include "render/occlusion.h"
#include "render/ramp.h"
#include "render/shadow.h"

namespace standoff {

/// Everything that light depends on, for all pixels.
struct Scenery {
  const Camera& camera;
  const Occlusion& occlusion;
  const Shadow& shadow;  ///< of the lamp
  Float3 to_lamp;
  const Ramp& ramp;
  Float3 up;                ///< of the world
  float pixel = 0;          ///< about the width of a pixel, in the unit space
  double contour_step = 0;  ///< between the contour lines of slices, world units
  Float3 outside, inside;   ///< of slices beyond the band
  bool perspective = true;
};

/// Towards the lamp, which stays above the eye's left shoulder.
Float3 to_lamp(const Camera& camera);

/// Shades points of triangles. How much light reaches a point changes slowly, so neighbours that ask one after the
/// other share it. One for each tile: what is shared must not depend on the order in which tiles are drawn.
class Shader {
 public:
  explicit Shader(const Scenery& scenery) : scenery_(scenery) {}

  struct Seen {
    Float3 color;  ///< linear
    float opacity;
  };
  /// A triangle of a part at a place of the picture, subpixels, within the triangle.
  Seen seen(const SeenPart& part, std::uint32_t triangle, float x, float y);
  /// To be called where the next point is no neighbour of the last.
  void forget() { lighting_known_ = false; }

 private:
  struct Weights {
    float a, b, c;
  };
  Weights weights(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c, double x, double y) const;
  Seen of_slice(const SeenPart& part, const Triangle& v, float x, float y) const;
  Float3 color(const SeenPart& part, const Triangle& v, float x, float y);
  Float3 lit(Float3 color, Float3 point, Float3 normal);

  const Scenery& scenery_;
  bool lighting_known_ = false;
  Float3 known_point_, known_normal_;
  float known_ambient_ = 1, known_lamp_ = 1;
};

}  // namespace standoff
