// SPDX-License-Identifier: Apache-2.0
#include "render/light.h"

namespace standoff {
namespace {

// Smooth normals farther than 45 degrees from the triangle's own are not used: the edge there is sharp.
constexpr float kCrease = 0.70F;

// Widths of lines on slices in pixels, and how dark they are.
constexpr double kZeroLine = 2.2, kLine = 1.2;
constexpr float kZeroShare = 0.95F, kLineShare = 0.5F;

// A soft sky over a lighter ground, and a lamp above the eye's left shoulder. Chosen by eye.
constexpr Float3 kLampInEyesAxes{-0.43F, 0.62F, 0.66F};
constexpr Float3 kSky{0.52F, 0.55F, 0.60F}, kGround{0.27F, 0.25F, 0.24F}, kLamp{1.30F, 1.24F, 1.16F};

}  // namespace

Float3 to_lamp(const Camera& camera) { return unit_or(camera.turned_back(kLampInEyesAxes), {0, 0, 1}); }

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
  const float facing = dot(normal, scenery_.to_lamp);
  if (!shared) {
    known_ambient_ = scenery_.occlusion.ambient(point, normal);
    known_lamp_ = facing > -0.2F ? scenery_.shadow.passing(point, normal) : 0;
    known_point_ = point;
    known_normal_ = normal;
    lighting_known_ = true;
  }
  const float sky = 0.5F + 0.5F * dot(normal, scenery_.up);
  const Float3 light = (kSky * sky + kGround * (1 - sky)) * known_ambient_ +
                       kLamp * (std::max(0.0F, facing) * known_lamp_ * (0.5F + 0.5F * known_ambient_));
  return color * light;
}

// A line as wide as 2 * half_width pixels, `away` pixels from its middle.
float covered_by_line(double away, double half_width) {
  return static_cast<float>(std::clamp(half_width + 0.5 - away, 0.0, 1.0));
}

float steepness(float to_right, float down) { return std::sqrt(to_right * to_right + down * down); }

Float3 mixed(Float3 a, Float3 b, float share) { return a * (1 - share) + b * share; }

Shader::Seen Shader::of_slice(const SeenPart& part, const Triangle& v, float x, float y) const {
  const DrawnPart& p = *part.part;
  const SliceTexture& slice = *p.slice;
  const auto values_at = [&](double px, double py) {
    const Weights w = weights(part.points[v[0]], part.points[v[1]], part.points[v[2]], px, py);
    const auto &a = p.on_slice[v[0]], &b = p.on_slice[v[1]], &c = p.on_slice[v[2]];
    return slice.at(a[0] * w.a + b[0] * w.b + c[0] * w.c, a[1] * w.a + b[1] * w.b + c[1] * w.c);
  };
  const auto [value, edge] = values_at(x, y);
  const float opacity = value < 0 ? 1.0F : p.opacity;
  // Beyond the band between all samples around, or no number.
  if (!std::isfinite(value) || std::abs(value) >= slice.thickness())
    return {value < 0 ? scenery_.inside : scenery_.outside, opacity};
  const SliceTexture::Values right = values_at(x + kSubpixels, y), down = values_at(x, y + kSubpixels);
  Seen seen{scenery_.ramp.color(value), opacity};
  // How far from places of a certain value, in pixels, if values were linear here.
  if (const float per_pixel = steepness(right.edge - edge, down.edge - edge); per_pixel > 0) {
    const auto share_above = [&](float level) { return std::clamp((edge - level) / per_pixel + 0.5F, 0.0F, 1.0F); };
    seen.color = mixed(seen.color, scenery_.outside, share_above(slice.thickness()));
    seen.color = mixed(scenery_.inside, seen.color, share_above(-slice.thickness()));
  }
  const float per_pixel = steepness(right.value - value, down.value - value);
  if (!(scenery_.contour_step > 0) || !(per_pixel > 0) || std::abs(edge) > slice.thickness()) return seen;
  const double line = std::round(value / scenery_.contour_step);
  const double away = std::abs(value - line * scenery_.contour_step) / per_pixel;
  const float covered =
      line == 0 ? kZeroShare * covered_by_line(away, kZeroLine / 2) : kLineShare * covered_by_line(away, kLine / 2);
  // A line is as opaque as it is dark, where the rest is see-through.
  return {seen.color * (1 - covered), std::max(opacity, covered)};
}

Shader::Seen Shader::seen(const SeenPart& part, std::uint32_t triangle, float x, float y) {
  const Triangle v = part.part->triangles[triangle];
  if (part.part->slice) return of_slice(part, v, x, y);
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
