// SPDX-License-Identifier: Apache-2.0
#include "render/light.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cstdint>

#include "standoff/compute.h"

namespace standoff {
namespace {

constexpr std::uint32_t kLarge = 0xFFFFFFFF;  // no cube's number

bool is_small(Float3 a, Float3 b, Float3 c, float size) {
  const auto within = [size](float p, float q, float r) { return std::max({p, q, r}) - std::min({p, q, r}) < size; };
  return within(a.x, b.x, c.x) && within(a.y, b.y, c.y) && within(a.z, b.z, c.z);
}

}  // namespace

std::vector<Triangle> thinned(std::span<const Float3> places, TriangleArray triangles, float size) {
  const auto side = static_cast<std::uint32_t>(2 / size) + 1;  // of the cubes around the unit sphere
  const auto cube = [&](Float3 p) {
    const auto along = [&](float x) {
      return std::min(side - 1, static_cast<std::uint32_t>(std::max(0.0F, (x + 1) / size)));
    };
    return along(p.x) + side * (along(p.y) + side * along(p.z));
  };
  std::vector<std::uint32_t> cubes(triangles.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cubes.size(), 1 << 14), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      const Triangle t = triangles[n];
      const Float3 &a = places[t[0]], &b = places[t[1]], &c = places[t[2]];
      cubes[n] = is_small(a, b, c, size) ? cube(a) : kLarge;
    }
  });
  // One thread goes through the triangles in order: which are kept must not depend on the number of threads.
  std::vector<bool> taken(std::size_t{side} * side * side);
  std::vector<Triangle> kept;
  for (std::size_t n = 0; n < cubes.size(); ++n) {
    if (cubes[n] != kLarge) {
      if (taken[cubes[n]]) continue;
      taken[cubes[n]] = true;
    }
    kept.push_back(triangles[n]);
  }
  return kept;
}

namespace {

constexpr std::int64_t kSamples = 96;  // along the longest side: shadows and creases of 1/50 of the scene
// Triangles smaller than this, in the unit space, are thinned out: a quarter of the spacing in a scene of usual shape.
constexpr float kSmall = 0.004F;
constexpr float kReach = 12;  // thickness of the band in spacings: how far a crease darkens
// Nearer than this to a surface the interpolated field says little about it, in spacings.
constexpr float kLeave = 1.5F;

bool casts(const DrawnPart& part) { return part.casts_shadow && part.opacity >= 1 && !part.triangles.empty(); }

}  // namespace

Occlusion::Occlusion(std::span<const DrawnPart> parts) {
  std::vector<const DrawnPart*> casting;
  for (const DrawnPart& part : parts)
    if (casts(part)) casting.push_back(&part);
  if (casting.empty()) return;

  static_assert(sizeof(Float3) == 3 * sizeof(float));
  std::vector<Float3> places;
  std::vector<Triangle> triangles;
  for (const DrawnPart* part : casting) {
    const auto first = static_cast<std::uint32_t>(places.size());
    if (casting.size() > 1) places.insert(places.end(), part->places.begin(), part->places.end());
    for (const Triangle& t : thinned(part->places, part->triangles, kSmall))
      triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  const std::vector<Float3>& all = casting.size() > 1 ? places : casting[0]->places;
  Box box;
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t) box.include({all[v].x, all[v].y, all[v].z});
  const Grid grid = fit_resolution(box, kSamples, Padding{});
  lattice_ = {{static_cast<float>(grid.origin.x), static_cast<float>(grid.origin.y), static_cast<float>(grid.origin.z)},
              static_cast<float>(grid.max_spacing()),
              {static_cast<std::size_t>(grid.size.x), static_cast<std::size_t>(grid.size.y),
               static_cast<std::size_t>(grid.size.z)}};
  thickness_ = kReach * lattice_.spacing;
  distances_.resize(lattice_.samples());
  ComputeOptions options{.sign = {SignMethod::none}};
  options.memory_limit = kNoMemoryLimit;  // the picture's has been asked
  options.hash_mesh = false;
  options.execution.backend = Backend::cpu;
  compute_into({{&all[0].x, all.size()}, triangles}, grid, thickness_, distances_, options);
}

std::int64_t Occlusion::bytes(std::int64_t triangles, std::int64_t vertices) {
  const Grid most{{kSamples, kSamples, kSamples}, {}, {1, 1, 1}};
  return estimate(std::max(triangles, std::int64_t{1}), most, kReach, {.sign = {SignMethod::none}}).dense +
         static_cast<std::int64_t>(sizeof(float)) * most.sample_count() +
         static_cast<std::int64_t>(sizeof(Triangle)) * triangles + static_cast<std::int64_t>(sizeof(Float3)) * vertices;
}

float Occlusion::distance(Float3 place) const {
  const auto cell = lattice_.cell(place);
  return cell ? lattice_.interpolate(*cell, [&](std::size_t sample) { return distances_[sample]; }) : thickness_;
}

Float3 Occlusion::above(Float3 point, Float3 normal) const { return point + normal * (kLeave * lattice_.spacing); }

float Occlusion::ambient(Float3 point, Float3 normal) const {
  if (distances_.empty()) return 1;
  // How much nearer than the surface itself something else is, at a few heights above it (Evans 2006).
  constexpr struct { float height, weight; } kTaps[] = {{kLeave, 0.30F}, {3, 0.30F}, {6, 0.25F}, {11, 0.25F}};
  float missing = 0;
  for (const auto& tap : kTaps) {
    const float height = tap.height * lattice_.spacing;
    missing += tap.weight * std::max(0.0F, 1 - distance(point + normal * height) / height);
  }
  return 1 - std::min(0.85F, missing);
}

float Occlusion::lamp(Float3 place, Float3 to_lamp) const {
  if (distances_.empty()) return 1;
  const float spacing = lattice_.spacing;
  constexpr int kMostSteps = 32;
  constexpr float kSharpness = 7;  // the half shadow is 1/7 as wide as what casts it is far away
  const float farthest = 2;        // the scene's diameter
  // Farther away the field's thickness stands for greater distances, which must not look like a half shadow.
  const float farthest_known = 0.95F * kSharpness * thickness_;
  float passes = 1;
  float along = kLeave * spacing;
  for (int step = 0; step < kMostSteps && along < farthest; ++step) {
    const float d = distance(place + to_lamp * along);
    passes = std::min(passes, kSharpness * std::max(0.0F, d - 0.25F * spacing) / std::min(along, farthest_known));
    if (passes < 0.01F) return 0;
    along += std::max(d, 0.75F * spacing);
  }
  return passes * passes * (3 - 2 * passes);
}

Shadow::Shadow(const Occlusion& occlusion, Float3 to_lamp)
    : occlusion_(occlusion), to_lamp_(to_lamp), known_(occlusion.lattice().samples(), -1.0F) {}

float Shadow::at_sample(std::size_t sample) const {
  const std::atomic_ref known(known_[sample]);
  float passes = known.load(std::memory_order_relaxed);
  if (passes < 0) {
    passes = occlusion_.lamp(occlusion_.lattice().place(sample), to_lamp_);
    known.store(passes, std::memory_order_relaxed);
  }
  return passes;
}

float Shadow::passing(Float3 point, Float3 normal) const {
  const UnitLattice& lattice = occlusion_.lattice();
  const auto cell = lattice.cell(occlusion_.above(point, normal));
  if (!cell) return 1;
  return lattice.interpolate(*cell, [&](std::size_t sample) { return at_sample(sample); });
}

namespace {

// Smooth normals farther than 45 degrees from the triangle's own are not used: the edge there is sharp.
constexpr float kCrease = 0.70F;

// Widths of lines on slices in pixels, and how dark they are.
constexpr double kZeroLine = 2.2, kLine = 1.2;
constexpr float kZeroShare = 0.95F, kLineShare = 0.5F;

// A soft sky over a lighter ground, and a lamp above the eye's left shoulder. Chosen by eye.
constexpr Float3 kLampInEyesAxes{-0.43F, 0.62F, 0.66F};
constexpr Float3 kSky{0.52F, 0.55F, 0.60F}, kGround{0.27F, 0.25F, 0.24F}, kLamp{1.30F, 1.24F, 1.16F};

// How much a line covers of a pixel that is `away` pixels from its middle.
float covered_by_line(double away, double half_width) {
  return static_cast<float>(std::clamp(half_width + 0.5 - away, 0.0, 1.0));
}

float steepness(float to_right, float down) { return std::sqrt(to_right * to_right + down * down); }

Float3 mixed(Float3 a, Float3 b, float share) { return a * (1 - share) + b * share; }

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
  // All samples around are beyond the band, or one is no number.
  if (!std::isfinite(value) || std::abs(value) >= slice.thickness())
    return {value < 0 ? scenery_.inside : scenery_.outside, opacity};
  const SliceTexture::Values right = values_at(x + kSubpixels, y), down = values_at(x, y + kSubpixels);
  Seen seen{scenery_.ramp.color(value), opacity};
  // The distance in pixels to places of a given value, as if values were linear here.
  if (const float per_pixel = steepness(right.edge - edge, down.edge - edge); per_pixel > 0) {
    const auto share_above = [&](float level) { return std::clamp((edge - level) / per_pixel + 0.5F, 0.0F, 1.0F); };
    seen.color = mixed(seen.color, scenery_.outside, share_above(slice.thickness()));
    seen.color = mixed(scenery_.inside, seen.color, share_above(-slice.thickness()));
  }
  const float per_pixel = steepness(right.value - value, down.value - value);
  if (const float level = slice.surface_level(); value < level && level > 0)
    seen.color = mixed(seen.color, {1, 1, 1}, kZeroShare * std::clamp((level - value) / per_pixel + 0.5F, 0.0F, 1.0F));
  if (!(scenery_.contour_step > 0) || !(per_pixel > 0) || std::abs(edge) > slice.thickness()) return seen;
  const double line = std::round(value / scenery_.contour_step);
  const double away = std::abs(value - line * scenery_.contour_step) / per_pixel;
  // Lines nearer than eight pixels would hide the colors.
  const auto apart = static_cast<float>(scenery_.contour_step) / per_pixel;
  const float share = kLineShare * std::clamp((apart - 8) / 4, 0.0F, 1.0F);
  if (line == 0 && slice.surface_level() > 0) return seen;
  const float covered =
      line == 0 ? kZeroShare * covered_by_line(away, kZeroLine / 2) : share * covered_by_line(away, kLine / 2);
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
  if (p.exact_normals) {
    const Float3 given = p.normals[v[0]];
    normal = dot(given, eye) < 0 ? given * -1 : given;
  } else if (!p.normals.empty()) {
    const auto of_corner = [&](std::uint32_t n) {
      const float with = dot(p.normals[n], flat);
      return std::abs(with) < kCrease ? flat : p.normals[n] * (with < 0 ? -1.0F : 1.0F);
    };
    normal = unit_or(of_corner(v[0]) * w.a + of_corner(v[1]) * w.b + of_corner(v[2]) * w.c, flat);
  }
  return lit(color, point, normal);
}

}  // namespace standoff
