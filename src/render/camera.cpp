// SPDX-License-Identifier: Apache-2.0
#include "render/camera.h"

#include <numbers>

namespace standoff {

// Sums a series: the last bits of std::sin differ between machines, and would move vertices by a subpixel.
Turn turn_of(double degrees) {
  double rest = std::remainder(degrees, 360);
  const auto quarters = static_cast<int>(std::lround(rest / 90));
  rest = (rest - 90 * quarters) * (std::numbers::pi / 180);  // at most 45 degrees
  const double square = rest * rest;
  double sine = 1, cosine = 1;
  for (int n = 20; n >= 2; n -= 2) {
    sine = 1 - sine * square / (n * (n + 1));
    cosine = 1 - cosine * square / (n * (n - 1));
  }
  sine *= rest;
  switch (quarters & 3) {
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    case 3:
      return {-cosine, sine};
    default:
      return {sine, cosine};
  }
}

namespace {

// A direction in axes with z up and the front at -y, turned into the world's axes.
Float3 from_z_up(Vec3 v, Axis up) {
  const auto narrow = [](double x, double y, double z) {
    return Float3{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  };
  switch (up) {
    case Axis::x:
      return narrow(v.z, v.x, v.y);
    case Axis::y:
      return narrow(v.x, v.z, -v.y);
    default:
      return narrow(v.x, v.y, v.z);
  }
}

}  // namespace

UnitSpace::UnitSpace(const Box& bounds) {
  // Halves are added and quotients are squared, so that nothing overflows: any finite box is drawn.
  center_ = bounds.min * 0.5 + bounds.max * 0.5;
  const Vec3 half = bounds.max * 0.5 - bounds.min * 0.5;
  const double longest = std::max({half.x, half.y, half.z});
  if (!(longest > 0)) return;
  unit_ = longest;
  scale_ = 1 / length(Vec3{half.x / longest, half.y / longest, half.z / longest});
}

Camera::Camera(const PictureOptions& options) : perspective_(options.perspective) {
  const Turn turn = turn_of(options.azimuth_deg), rise = turn_of(options.elevation_deg);
  const Vec3 back{rise.cosine * turn.sine, -rise.cosine * turn.cosine, rise.sine};
  const Vec3 right{turn.cosine, turn.sine, 0};
  const Axis up = options.up.value_or(Axis::z);
  right_ = from_z_up(right, up);
  back_ = from_z_up(back, up);
  up_ = from_z_up(cross(back, right), up);
}

Framing::Framing(double least_u, double least_v, double most_u, double most_v, const Room& room, double zoom)
    : middle_u_(0.5 * (least_u + most_u)),
      middle_v_(0.5 * (least_v + most_v)),
      middle_x_((room.left + 0.5 * room.width) * kSubpixels),
      middle_y_((room.top + 0.5 * room.height) * kSubpixels) {
  // A point and its ball, or a line seen from its end, need not fill the room.
  constexpr double kLeastExtent = 0.05;
  const double unit = std::max({(most_u - least_u) / room.width, (most_v - least_v) / room.height,
                                kLeastExtent / std::min(room.width, room.height)});
  zoom_ = kSubpixels * zoom / unit;
}

}  // namespace standoff
