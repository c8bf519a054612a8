// SPDX-License-Identifier: Apache-2.0
#include "render/light.h"

namespace standoff {
namespace {

// Smooth normals farther than 45 degrees from the triangle's own are not used: the edge there is sharp.
constexpr float kCrease = 0.70F;

// A soft sky over a lighter ground, and a lamp above the eye's left shoulder. Chosen by eye.
constexpr Float3 kLampInEyesAxes{-0.43F, 0.62F, 0.66F};
constexpr Float3 kSky{0.52F, 0.55F, 0.60F}, kGround{0.27F, 0.25F, 0.24F}, kLamp{1.30F, 1.24F, 1.16F};

}  // namespace

Shader::Shader(const Scenery& scenery)
    : scenery_(scenery), lamp_(unit_or(scenery.camera.turned_back(kLampInEyesAxes), {0, 0, 1})) {}

Shader::Weights Shader::weights(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c, double x,
                                double y) const {
  const double abx = double(b.x) - a.x, aby = double(b.y) - a.y, acx = double(c.x) - a.x, acy = double(c.y) - a.y;
  const double area = abx * acy - aby * acx;
  const double px = x - a.x, py = y - a.y;
  double wb = (px * acy - py * acx) / area, wc = (abx * py - aby * px) / area;
  double wa = 1 - wb - wc;
  if (scenery_.perspective) wa *= a.depth, wb *= b.depth, wc *= c.depth;
  const double sum = wa + wb + wc;
  return {static_cast<float>(wa / sum), static_cast<float>(wb / sum), static_cast<float>(wc / sum)};
}

Float3 Shader::lit(Float3 color, Float3 point, Float3 normal) {
  const float near = 3 * scenery_.pixel;
  const bool shared = lighting_known_ && dot(normal, known_normal_) > 0.97F &&
                      dot(point - known_point_, point - known_point_) < near * near;
  const float facing = dot(normal, lamp_);
  if (!shared) {
    known_ambient_ = scenery_.occlusion.ambient(point, normal);
    known_lamp_ = facing > -0.2F ? scenery_.occlusion.lamp(point, normal, lamp_) : 0;
    known_point_ = point;
    known_normal_ = normal;
    lighting_known_ = true;
  }
  const float sky = 0.5F + 0.5F * dot(normal, scenery_.up);
  const Float3 light = (kSky * sky + kGround * (1 - sky)) * known_ambient_ +
                       kLamp * (std::max(0.0F, facing) * known_lamp_ * (0.5F + 0.5F * known_ambient_));
  return color * light;
}

Shader::Seen Shader::of_field(const SeenPart& part, const Triangle& v, float x, float y) const {
  const DrawnPart& p = *part.part;
  const auto value_at = [&](double px, double py) {
    const Weights w = weights(part.points[v[0]], part.points[v[1]], part.points[v[2]], px, py);
    return p.field->interpolate(
        scenery_.space.world(p.places[v[0]] * w.a + p.places[v[1]] * w.b + p.places[v[2]] * w.c));
  };
  const double value = value_at(x, y);
  if (!std::isfinite(value) || std::abs(value) >= p.field->thickness() * (1 - 1e-6))
    return {value < 0 ? scenery_.inside : scenery_.outside, value < 0 ? 1.0F : p.opacity};
  const Float3 color = scenery_.ramp.color(static_cast<float>(value));
  const float opacity = value < 0 ? 1.0F : p.opacity;
  if (!(scenery_.contour_step > 0)) return {color, opacity};
  // How far from a contour line, in pixels, if the field were linear here.
  const double right = value_at(x + kSubpixels, y) - value, down = value_at(x, y + kSubpixels) - value;
  const double per_pixel = std::sqrt(right * right + down * down);
  if (!(per_pixel > 0)) return {color, opacity};
  const double line = std::round(value / scenery_.contour_step);
  const double away = std::abs(value - line * scenery_.contour_step) / per_pixel;
  const double half_width = line == 0 ? 1.1 : 0.5, darkness = line == 0 ? 0.9 : 0.35;
  const auto covered = static_cast<float>(std::clamp(half_width + 0.5 - away, 0.0, 1.0) * darkness);
  // A line is as opaque as it is dark, where the rest is see-through.
  return {color * (1 - covered), std::max(opacity, covered)};
}

Shader::Seen Shader::seen(const SeenPart& part, std::uint32_t triangle, float x, float y) {
  const Triangle v = part.part->triangles[triangle];
  if (part.part->field) return of_field(part, v, x, y);
  return {color(part, v, x, y), part.part->opacity};
}

Float3 Shader::color(const SeenPart& part, const Triangle& v, float x, float y) {
  const DrawnPart& p = *part.part;
  if (!p.lit && p.values.empty()) return p.color;
  const Weights w = weights(part.points[v[0]], part.points[v[1]], part.points[v[2]], x, y);
  const Float3 color = p.values.empty()
                           ? p.color
                           : scenery_.ramp.color(p.values[v[0]] * w.a + p.values[v[1]] * w.b + p.values[v[2]] * w.c);
  if (!p.lit) return color;
  const Float3 &a = p.places[v[0]], &b = p.places[v[1]], &c = p.places[v[2]];
  const Float3 point = a * w.a + b * w.b + c * w.c;
  const Float3 eye = scenery_.camera.to_eye(point);
  Float3 flat = unit_or(cross(b - a, c - a), unit_or(eye, {0, 0, 1}));
  if (dot(flat, eye) < 0) flat = flat * -1;
  Float3 normal = flat;
  if (!p.normals.empty()) {
    const auto of_corner = [&](std::uint32_t n) {
      const float with = dot(p.normals[n], flat);
      return std::abs(with) < kCrease ? flat : p.normals[n] * (with < 0 ? -1.0F : 1.0F);
    };
    normal = unit_or(of_corner(v[0]) * w.a + of_corner(v[1]) * w.b + of_corner(v[2]) * w.c, flat);
  }
  return lit(color, point, normal);
}

}  // namespace standoff
