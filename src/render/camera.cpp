// SPDX-License-Identifier: Apache-2.0
#include "render/camera.h"

#include <numbers>

namespace standoff {
namespace {

constexpr double kMargin = 0.04;  // of the picture's shorter side, on all sides
// The eye's distance from the centre of the unit sphere around the mesh: a field of view of 30 degrees.
constexpr double kEye = 3.86;

// From axes with z up and the front at -y to the world's.
Vec3 from_z_up(Vec3 v, Axis up) {
  switch (up) {
    case Axis::x:
      return {v.z, v.x, v.y};
    case Axis::y:
      return {v.x, v.z, -v.y};
    default:
      return v;
  }
}

}  // namespace

Camera::Camera(const Box& bounds, const PictureOptions& options) : perspective_(options.perspective) {
  // Halves before sums and quotients before squares: whatever fits a double is drawn, near its ends as well.
  center_ = bounds.min * 0.5 + bounds.max * 0.5;
  const Vec3 half = bounds.max * 0.5 - bounds.min * 0.5;
  const double longest = std::max({half.x, half.y, half.z});
  if (longest > 0) {
    unit_ = longest;
    scale_ = 1 / length({half.x / longest, half.y / longest, half.z / longest});
  }
  const double turn = options.azimuth_deg * std::numbers::pi / 180;
  const double rise = options.elevation_deg * std::numbers::pi / 180;
  const Vec3 back{std::cos(rise) * std::sin(turn), -std::cos(rise) * std::cos(turn), std::sin(rise)};
  const Vec3 right{std::cos(turn), std::sin(turn), 0};
  right_ = from_z_up(right, options.up);
  back_ = from_z_up(back, options.up);
  up_ = from_z_up(cross(back, right), options.up);
}

Vec3 Camera::placed(Vec3 point) const { return turned((point - center_) / Vec3{unit_, unit_, unit_} * scale_); }

Vec3 Camera::turned(Vec3 d) const { return {dot(d, right_), dot(d, up_), dot(d, back_)}; }

Vec3 Camera::facing_normal(Vec3 a, Vec3 b, Vec3 c) const {
  const Vec3 first = placed(a);
  const Vec3 normal = cross(placed(b) - first, placed(c) - first);
  const double size = length(normal);
  if (!(size > 0)) return {0, 0, 1};
  const Vec3 to_eye = perspective_ ? Vec3{0, 0, kEye} - first : Vec3{0, 0, 1};
  return normal * ((dot(normal, to_eye) < 0 ? -1 : 1) / size);
}

Camera::Seen Camera::seen(Vec3 point) const {
  const Vec3 p = placed(point);
  if (!perspective_) return {p.x, p.y, p.z};
  const double inverse = 1 / (kEye - p.z);
  return {p.x * inverse, p.y * inverse, inverse};
}

std::vector<ScreenPoint> Camera::project(MeshView mesh, int width, int height) const {
  Box box;
  for (const Triangle& triangle : mesh.triangles)
    for (const auto v : triangle) {
      const Seen s = seen(mesh.vertices[v]);
      box.include({s.u, s.v, 0});
    }
  const double margin = kMargin * std::min(width, height);
  const Vec3 extent = box.extent(), middle = box.center();
  const double unit = std::max(extent.x / (width - 2 * margin), extent.y / (height - 2 * margin));
  // A mesh seen as one point falls on the picture's centre.
  const double zoom = unit > 0 ? kSubpixels / unit : 0;

  std::vector<ScreenPoint> points(mesh.vertices.size());
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (!is_finite(mesh.vertices[v])) continue;
    const Seen s = seen(mesh.vertices[v]);
    const double x = 0.5 * kSubpixels * width + (s.u - middle.x) * zoom;
    const double y = 0.5 * kSubpixels * height - (s.v - middle.y) * zoom;
    // Vertices that no triangle uses may lie anywhere.
    if (!(std::abs(x) < 0x1p30 && std::abs(y) < 0x1p30)) continue;
    points[v] = {static_cast<std::int32_t>(std::lround(x)), static_cast<std::int32_t>(std::lround(y)),
                 static_cast<float>(s.depth)};
  }
  return points;
}

}  // namespace standoff
