// SPDX-License-Identifier: Apache-2.0
// From the world to the unit sphere, and from there to the picture.
#pragma once

#include <cstdint>

#include "render/float3.h"
#include "standoff/picture.h"

namespace standoff {

/// A vertex on the picture. Depth is 1/distance in perspective, and z + 2 towards the eye otherwise: both are positive,
/// linear over the picture and greater when nearer.
struct ScreenPoint {
  std::int32_t x = 0, y = 0;  ///< in kSubpixels per pixel, from the top left corner of the picture
  float depth = 0;
};
inline constexpr std::int32_t kSubpixels = 256;
/// No corner of a triangle may be farther from the picture's corner, subpixels.
inline constexpr double kMostSubpixels = 0x1p30;

/// An angle's sine and cosine, the same bits on every machine.
struct Turn {
  double sine, cosine;
};
Turn turn_of(double degrees);

/// Moves and scales all that is drawn into the sphere of radius 1 around the origin, where single precision serves all.
class UnitSpace {
 public:
  explicit UnitSpace(const Box& bounds);

  Float3 placed(Vec3 point) const {
    const Vec3 p = (point - center_) / Vec3{unit_, unit_, unit_} * scale_;
    return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  }
  /// World units in a unit.
  double world(double length) const { return length / scale_ * unit_; }
  /// The point of the world at a point of this space.
  Vec3 world(Float3 p) const { return center_ + Vec3{p.x, p.y, p.z} * (1 / scale_) * unit_; }

 private:
  Vec3 center_;
  // One factor could not be a double for all meshes.
  double unit_ = 1, scale_ = 1;
};

/// What the eye sees of the unit sphere, before it is fitted into a picture. Directions are right, up and towards the
/// eye.
class Camera {
 public:
  explicit Camera(const PictureOptions& options);

  /// A direction of the world in the eye's axes, and back.
  Float3 turned(Float3 d) const { return {dot(d, right_), dot(d, up_), dot(d, back_)}; }
  Float3 turned_back(Float3 d) const { return right_ * d.x + up_ * d.y + back_ * d.z; }
  /// From a point of the unit sphere to the eye.
  Float3 to_eye(Float3 point) const { return perspective_ ? back_ * kEye - point : back_; }

  struct Seen {
    float u, v, depth;  ///< on the plane of the picture, rightwards and upwards
  };
  Seen seen(Float3 point) const {
    const Float3 p = turned(point);
    if (!perspective_) return {p.x, p.y, p.z + 2};
    const float inverse = 1 / (kEye - p.z);
    return {p.x * inverse, p.y * inverse, inverse};
  }

 private:
  // The eye's distance from the centre of the unit sphere: a field of view of 30 degrees.
  static constexpr float kEye = 3.86F;

  Float3 right_, up_, back_;
  bool perspective_;
};

/// Where what a camera sees falls on a picture.
class Framing {
 public:
  /// The part of a picture that things are fitted into, pixels.
  struct Room {
    double left, top, width, height;
  };
  /// So that everything from (least_u, least_v) to (most_u, most_v) fills the room.
  Framing(double least_u, double least_v, double most_u, double most_v, const Room& room, double zoom);

  ScreenPoint on_picture(const Camera::Seen& seen) const {
    const double x = middle_x_ + (seen.u - middle_u_) * zoom_, y = middle_y_ - (seen.v - middle_v_) * zoom_;
    // Only what is left out comes so far.
    if (!(std::abs(x) < kMostSubpixels && std::abs(y) < kMostSubpixels)) return {};
    return {static_cast<std::int32_t>(std::lround(x)), static_cast<std::int32_t>(std::lround(y)), seen.depth};
  }
  /// Pixels in a unit of u and v.
  double pixels_per_unit() const { return zoom_ / kSubpixels; }

 private:
  double middle_u_, middle_v_, middle_x_, middle_y_, zoom_;
};

}  // namespace standoff
