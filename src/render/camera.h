// SPDX-License-Identifier: Apache-2.0
// Where the corners of a mesh fall on the picture.
#pragma once

#include <cstdint>
#include <vector>

#include "standoff/picture.h"

namespace standoff {

/// A vertex on the picture. Depth is 1/distance in perspective and -distance otherwise: both are linear over the
/// picture and greater when nearer.
struct ScreenPoint {
  std::int32_t x = 0, y = 0;  ///< in kSubpixels per pixel, from the top left corner of the picture
  float depth = 0;
};
inline constexpr std::int32_t kSubpixels = 256;

/// An eye that sees all of a mesh. Directions are right, up and towards the eye.
class Camera {
 public:
  Camera(const Box& bounds, const PictureOptions& options);

  /// A world direction in the eye's axes.
  Vec3 turned(Vec3 direction) const;
  /// The unit normal of a triangle on the side that the eye sees, in the eye's axes; of a degenerate one, towards the
  /// eye.
  Vec3 facing_normal(Vec3 a, Vec3 b, Vec3 c) const;
  /// All vertices that triangles use, on a picture of width x height with a margin; the others are left as they are.
  std::vector<ScreenPoint> project(MeshView mesh, int width, int height) const;

 private:
  struct Seen {
    double u, v, depth;
  };
  Vec3 placed(Vec3 point) const;
  Seen seen(Vec3 point) const;

  Vec3 center_, right_, up_, back_;
  // Divided by unit_, then times scale_, the mesh is in the unit sphere. One factor could not be a double for all
  // meshes.
  double unit_ = 1, scale_ = 1;
  bool perspective_;
};

}  // namespace standoff
