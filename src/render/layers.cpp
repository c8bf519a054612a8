// SPDX-License-Identifier: Apache-2.0
// The layers of a drawing: whether they can be drawn, how far they and their numbers reach, and what they become.

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <utility>

#include "render/image.h"
#include "render/part.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// Balls and tubes as triangles.

/// How finely round things are divided, so that none looks angular at its size.
struct Roundness {
  int ball_level;  ///< an octahedron (0), or an icosahedron (1) whose triangles are quartered (2, 3)
  int tube_sides;

  /// For things with a radius of so many pixels.
  static Roundness of(float radius_px);

  /// What a ball and a tube consist of.
  struct Size {
    std::size_t vertices, triangles;
  };
  Size ball() const;
  Size tube() const;
};

/// Adds balls and tubes to a part. Each vertex gets a normal, and a value where the part has values.
class ShapeBuilder {
 public:
  ShapeBuilder(DrawnPart& part, float radius, Roundness roundness, bool with_values);

  /// Call this first, with the most that will be added: memory is then allocated once.
  void reserve(std::size_t balls, std::size_t tubes);
  void add_ball(Float3 center, float value = 0);
  /// One that is lit as a surface with this normal.
  void add_ball(Float3 center, float value, Float3 normal);
  /// The tube has no caps.
  void add_tube(Float3 from, Float3 to, float value_from = 0, float value_to = 0);
  /// Call this when all is added.
  void finish() { part_.use_own(); }

 private:
  std::uint32_t add_vertex(Float3 place, Float3 normal, float value);

  DrawnPart& part_;
  float radius_;
  Roundness roundness_;
  bool with_values_;
  std::vector<Float3> ball_;
  std::vector<Triangle> ball_triangles_;
  std::vector<std::array<float, 2>> ring_;  // cosines and sines
};

struct Ball {
  std::vector<Float3> places;  // on the unit sphere
  std::vector<Triangle> triangles;
};

Ball octahedron() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

Ball icosahedron() {
  constexpr float kLong = 0.85065081F, kShort = 0.52573111F;  // the golden ratio and 1, in the unit sphere
  Ball ball;
  for (const float a : {-kLong, kLong})
    for (const float b : {-kShort, kShort}) {
      ball.places.push_back({0, b, a});
      ball.places.push_back({b, a, 0});
      ball.places.push_back({a, 0, b});
    }
  // Corners are neighbours where they are 2 * kShort apart.
  const auto near = [&](std::uint32_t a, std::uint32_t b) { return dot(ball.places[a], ball.places[b]) > 0.4F; };
  for (std::uint32_t a = 0; a < 12; ++a)
    for (std::uint32_t b = a + 1; b < 12; ++b)
      for (std::uint32_t c = b + 1; c < 12; ++c)
        if (near(a, b) && near(b, c) && near(a, c)) ball.triangles.push_back({a, b, c});
  return ball;
}

Ball quartered(const Ball& ball) {
  Ball fine{ball.places, {}};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [found, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(fine.places.size()));
    if (is_new) fine.places.push_back(unit_or(fine.places[a] + fine.places[b], {}));
    return found->second;
  };
  for (const auto& [a, b, c] : ball.triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.triangles.insert(fine.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return fine;
}

Ball ball_of(int level) {
  if (level == 0) return octahedron();
  Ball ball = icosahedron();
  for (int n = 1; n < level; ++n) ball = quartered(ball);
  return ball;
}

// At least `sides` points on the unit circle: the arcs between four points are halved until there are enough.
std::vector<std::array<float, 2>> ring_of(int sides) {
  std::vector<std::array<float, 2>> ring{{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  while (ring.size() < static_cast<std::size_t>(sides)) {
    std::vector<std::array<float, 2>> fine;
    for (std::size_t n = 0; n < ring.size(); ++n) {
      const auto &a = ring[n], &b = ring[(n + 1) % ring.size()];
      const Float3 middle = unit_or({a[0] + b[0], a[1] + b[1], 0}, {});
      fine.push_back(a);
      fine.push_back({middle.x, middle.y});
    }
    ring = std::move(fine);
  }
  return ring;
}

Roundness Roundness::of(float radius_px) {
  if (radius_px < 2) return {0, 4};
  if (radius_px < 4) return {1, 8};
  return radius_px < 10 ? Roundness{2, 8} : Roundness{3, 16};
}

Roundness::Size Roundness::ball() const {
  if (ball_level == 0) return {6, 8};
  const std::size_t quarters = std::size_t{1} << (2 * (ball_level - 1));
  return {10 * quarters + 2, 20 * quarters};
}

Roundness::Size Roundness::tube() const {
  const auto sides = static_cast<std::size_t>(tube_sides);
  return {2 * sides, 2 * sides};
}

ShapeBuilder::ShapeBuilder(DrawnPart& part, float radius, Roundness roundness, bool with_values)
    : part_(part),
      radius_(radius),
      roundness_(roundness),
      with_values_(with_values),
      ring_(ring_of(roundness.tube_sides)) {
  Ball ball = ball_of(roundness.ball_level);
  ball_ = std::move(ball.places);
  ball_triangles_ = std::move(ball.triangles);
}

void ShapeBuilder::reserve(std::size_t balls, std::size_t tubes) {
  const auto [ball, tube] = std::pair(roundness_.ball(), roundness_.tube());
  const std::size_t vertices = balls * ball.vertices + tubes * tube.vertices;
  part_.places.reserve(vertices);
  part_.normals.reserve(vertices);
  if (with_values_) part_.values.reserve(vertices);
  part_.own.reserve(balls * ball.triangles + tubes * tube.triangles);
}

std::uint32_t ShapeBuilder::add_vertex(Float3 place, Float3 normal, float value) {
  part_.places.push_back(place);
  part_.normals.push_back(normal);
  if (with_values_) part_.values.push_back(value);
  return static_cast<std::uint32_t>(part_.places.size() - 1);
}

void ShapeBuilder::add_ball(Float3 center, float value) {
  const auto first = static_cast<std::uint32_t>(part_.places.size());
  for (const Float3& p : ball_) add_vertex(center + p * radius_, p, value);
  for (const auto& [a, b, c] : ball_triangles_) part_.own.push_back({first + a, first + b, first + c});
}

void ShapeBuilder::add_ball(Float3 center, float value, Float3 normal) {
  add_ball(center, value);
  std::fill(part_.normals.end() - static_cast<std::ptrdiff_t>(ball_.size()), part_.normals.end(), normal);
}

void ShapeBuilder::add_tube(Float3 from, Float3 to, float value_from, float value_to) {
  const Float3 along = unit_or(to - from, {});
  if (along.x == 0 && along.y == 0 && along.z == 0) return;
  // Any direction across the tube: perpendicular to it and to the axis that it is least along.
  const float x = std::abs(along.x), y = std::abs(along.y), z = std::abs(along.z);
  const Float3 least = x <= y && x <= z ? Float3{1, 0, 0} : y <= z ? Float3{0, 1, 0} : Float3{0, 0, 1};
  const Float3 side = unit_or(cross(along, least), {}), other = cross(along, side);
  const auto first = static_cast<std::uint32_t>(part_.places.size());
  const auto sides = static_cast<std::uint32_t>(ring_.size());
  for (const auto& [cosine, sine] : ring_) {
    const Float3 normal = side * cosine + other * sine;
    add_vertex(from + normal * radius_, normal, value_from);
    add_vertex(to + normal * radius_, normal, value_to);
  }
  for (std::uint32_t n = 0; n < sides; ++n) {
    const std::uint32_t a = first + 2 * n, b = first + 2 * ((n + 1) % sides);
    part_.own.push_back({a, b, a + 1});
    part_.own.push_back({b, b + 1, a + 1});
  }
}

// Layers.

constexpr Color kLineColor{40, 44, 52};
// Balls of a smaller radius are lit as the surface that they make: the shades of each would make moire.
constexpr float kFewPixels = 1.5F;
constexpr float kPointPixels = 4, kPathPixels = 1.8F, kLinePixels = 0.7F;  // default radii

float radius_in(const UnitSpace& space, double radius, float otherwise) {
  return radius > 0 ? static_cast<float>(radius / space.world(1.0)) : otherwise;
}

float radius_of(const BandLayer& band, const UnitSpace& space) {
  const Vec3 spacing = band.field->grid().spacing;
  // They touch: gaps of about a pixel make moire.
  return 0.62F * static_cast<float>(std::min({spacing.x, spacing.y, spacing.z}) / space.world(1.0));
}

template <class Use>
void for_band_samples(const BandLayer& band, const Use& use) {
  const DistanceField& field = *band.field;
  const Grid& grid = field.grid();
  const auto most = static_cast<float>(std::min(band.within, field.thickness()));
  for (const DistanceField::Tile& tile : field.tiles()) {
    constexpr std::int64_t kSide = DistanceField::kTileSide;
    const Size3 first{tile.at.x * kSide, tile.at.y * kSide, tile.at.z * kSide};
    std::size_t n = 0;
    for (std::int64_t k = first.z; k < first.z + kSide; ++k)
      for (std::int64_t j = first.y; j < first.y + kSide; ++j)
        for (std::int64_t i = first.x; i < first.x + kSide; ++i, ++n)
          if (i < grid.size.x && j < grid.size.y && k < grid.size.z && std::abs(tile.values[n]) < most)
            use(grid.position(i, j, k), tile.values[n]);
  }
}

std::size_t count_of(const BandLayer& band) {
  std::size_t samples = 0;
  for_band_samples(band, [&](Vec3, float) { ++samples; });
  return samples;
}

SliceOptions options_of(const SliceLayer& slice) {
  SliceOptions options;
  options.axis = slice.axis;
  options.at = slice.at;
  return options;
}

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::usage, "picture: " + what); }

void check_lengths(const char* layer, std::size_t values, std::size_t points) {
  if (values != 0 && values != points)
    refuse(std::string("the ") + layer + " layer has " + std::to_string(values) + " values for " +
           std::to_string(points) + " points; give one for each, or none");
}

}  // namespace

void check(const Drawing& drawing) {
  for (const MeshLayer& layer : drawing.meshes) {
    validate(layer.mesh);
    check_lengths("mesh", layer.values.size(), layer.mesh.vertices.size());
    if (!layer.normals.empty() && layer.normals.size() != layer.mesh.vertices.size())
      refuse("the mesh layer has " + std::to_string(layer.normals.size()) + " normals for " +
             std::to_string(layer.mesh.vertices.size()) + " vertices; give one for each, or none");
    if (!(layer.opacity >= 0 && layer.opacity <= 1)) refuse("the opacity must be 0 to 1; 0.3 lets much through");
  }
  for (const SliceLayer& slice : drawing.slices) {
    if (!slice.field) refuse("a slice layer has no field; give one");
    if (!(slice.at >= 0 && slice.at <= 1)) refuse("a slice's position must be 0 to 1; 0.5 is the middle");
    if (!(slice.outside_opacity >= 0 && slice.outside_opacity <= 1))
      refuse("a slice's opacity must be 0 to 1; 1 hides what is behind");
    if (slice.axis != Axis::x && slice.axis != Axis::y && slice.axis != Axis::z)
      refuse("there is no such axis; take x, y or z");
  }
  for (const BandLayer& band : drawing.bands)
    if (!band.field) refuse("a band layer has no field; give one");
  for (const PointLayer& layer : drawing.points) {
    check_lengths("point", layer.values.size(), layer.points.size());
    if (!(layer.radius >= 0 && std::isfinite(layer.radius)))
      refuse("a radius must be finite and not negative; 0 is a few pixels");
  }
  for (const PathLayer& layer : drawing.paths) {
    check_lengths("path", layer.values.size(), layer.points.size());
    if (!(layer.radius >= 0 && std::isfinite(layer.radius)))
      refuse("a radius must be finite and not negative; 0 is a few pixels");
    for (std::size_t n = 0; n < layer.starts.size(); ++n)
      if (layer.starts[n] > layer.points.size() || (n > 0 && layer.starts[n] < layer.starts[n - 1]))
        refuse("the starts of paths must ascend and be at most the number of points; give the first point of each");
  }
  for (const BoxLayer& layer : drawing.boxes)
    if (layer.box.empty() || !is_finite(layer.box.min) || !is_finite(layer.box.max))
      refuse("a box must be finite and not empty; give a lower and an upper corner");
}

NumberRange number_range(const Drawing& drawing) {
  NumberRange range;
  const auto include_all = [&](std::span<const double> values) {
    for (const double value : values) range.include(value);
  };
  for (const MeshLayer& layer : drawing.meshes) include_all(layer.values);
  for (const PointLayer& layer : drawing.points) include_all(layer.values);
  for (const PathLayer& layer : drawing.paths) include_all(layer.values);
  const bool automatic = drawing.colormap == Colormap::automatic;
  for (const SliceLayer& slice : drawing.slices) {
    const std::vector<float> values = plane_of(*slice.field, options_of(slice)).values;
    const auto end = automatic && !slice.field->has_sign() ? early_end(values) : std::nullopt;
    range.ends_early |= end.has_value();
    for (const float value : values) range.include(end ? std::min(value, *end) : value);
    range.thickness = std::min(range.thickness, slice.field->thickness());
  }
  for (const BandLayer& band : drawing.bands) {
    for_band_samples(band, [&](Vec3, float value) { range.include(value); });
    range.thickness = std::min(range.thickness, band.field->thickness());
  }
  return range;
}

Box bounds_of(const Drawing& drawing, const std::vector<std::vector<char>>& unused) {
  Box box;
  const auto include = [&](const Box& other) {
    if (other.empty()) return;
    box.include(other.min);
    box.include(other.max);
  };
  const auto include_points = [&](std::span<const Vec3> points) {
    for (const Vec3& p : points)
      if (is_finite(p)) box.include(p);
  };
  for (std::size_t n = 0; n < drawing.meshes.size(); ++n) include(bounds_of_used(drawing.meshes[n].mesh, unused[n]));
  for (const SliceLayer& slice : drawing.slices) include(slice.field->grid().bounds());
  for (const BandLayer& band : drawing.bands) for_band_samples(band, [&](Vec3 p, float) { box.include(p); });
  for (const PointLayer& layer : drawing.points) include_points(layer.points);
  for (const PathLayer& layer : drawing.paths) include_points(layer.points);
  for (const BoxLayer& layer : drawing.boxes) include(layer.box);
  return box;
}

double position_of(const SliceLayer& slice) { return slice_plane(*slice.field, options_of(slice)).position; }

void add_slices(const Drawing& drawing, const UnitSpace& space, std::vector<DrawnPart>& parts) {
  for (const SliceLayer& slice : drawing.slices) {
    DrawnPart part;
    part.slice = std::make_shared<SliceTexture>(*slice.field, options_of(slice));
    part.opacity = static_cast<float>(slice.outside_opacity);
    part.lit = false;
    part.casts_shadow = false;
    const Plane& plane = part.slice->plane();
    for (const std::int64_t up : {std::int64_t{0}, plane.height - 1})
      for (const std::int64_t right : {std::int64_t{0}, plane.width - 1}) {
        part.on_slice.push_back({static_cast<float>(right), static_cast<float>(up)});
        part.places.push_back(space.placed(slice.field->grid().position(slice.axis == Axis::x ? plane.index : right,
                                                                        slice.axis == Axis::y   ? plane.index
                                                                        : slice.axis == Axis::x ? right
                                                                                                : up,
                                                                        slice.axis == Axis::z ? plane.index : up)));
      }
    part.own = {{0, 1, 2}, {1, 3, 2}};
    part.use_own();
    parts.push_back(std::move(part));
  }
}

void add_bands(const Drawing& drawing, const UnitSpace& space, float pixel, std::vector<DrawnPart>& parts) {
  for (const BandLayer& band : drawing.bands) {
    const float radius = radius_of(band, space);
    DrawnPart part;
    part.casts_shadow = false;  // so many balls would darken each other
    part.exact_normals = radius < kFewPixels * pixel;
    ShapeBuilder shapes(part, radius, Roundness::of(radius / pixel), true);
    shapes.reserve(count_of(band), 0);
    for_band_samples(band, [&](Vec3 p, float value) {
      if (!part.exact_normals) return shapes.add_ball(space.placed(p), value);
      const Vec3 g = band.field->gradient(p, Outside::border);
      const Float3 normal{static_cast<float>(g.x), static_cast<float>(g.y), static_cast<float>(g.z)};
      shapes.add_ball(space.placed(p), value, unit_or(normal, {0, 0, 1}));
    });
    shapes.finish();
    parts.push_back(std::move(part));
  }
}

void add_points(const Drawing& drawing, const UnitSpace& space, float pixel, std::vector<DrawnPart>& parts) {
  for (const PointLayer& layer : drawing.points) {
    const float radius = radius_in(space, layer.radius, kPointPixels * pixel);
    DrawnPart part;
    part.color = linear_of(layer.color);
    ShapeBuilder shapes(part, radius, Roundness::of(radius / pixel), !layer.values.empty());
    shapes.reserve(layer.points.size(), 0);
    for (std::size_t n = 0; n < layer.points.size(); ++n)
      if (is_finite(layer.points[n]))
        shapes.add_ball(space.placed(layer.points[n]), layer.values.empty() ? 0 : static_cast<float>(layer.values[n]));
    shapes.finish();
    parts.push_back(std::move(part));
  }
}

void add_paths(const Drawing& drawing, const UnitSpace& space, float pixel, std::vector<DrawnPart>& parts) {
  for (const PathLayer& layer : drawing.paths) {
    const float radius = radius_in(space, layer.radius, kPathPixels * pixel);
    DrawnPart part;
    part.color = linear_of(layer.color);
    ShapeBuilder shapes(part, radius, Roundness::of(radius / pixel), !layer.values.empty());
    const auto value = [&](std::size_t n) { return layer.values.empty() ? 0.0F : static_cast<float>(layer.values[n]); };
    shapes.reserve(layer.points.size(), layer.points.size());
    auto start = layer.starts.begin();
    bool connected = false;
    for (std::size_t n = 0; n < layer.points.size(); ++n) {
      for (; start != layer.starts.end() && *start == n; ++start) connected = false;
      if (!is_finite(layer.points[n])) {
        connected = false;
        continue;
      }
      const Float3 here = space.placed(layer.points[n]);
      if (connected) shapes.add_tube(space.placed(layer.points[n - 1]), here, value(n - 1), value(n));
      shapes.add_ball(here, value(n));  // rounds the joint
      connected = true;
    }
    shapes.finish();
    parts.push_back(std::move(part));
  }
}

void add_boxes(const Drawing& drawing, const UnitSpace& space, float pixel, std::vector<DrawnPart>& parts) {
  for (const BoxLayer& layer : drawing.boxes) {
    DrawnPart part;
    part.color = linear_of(layer.color);
    part.lit = false;
    part.casts_shadow = false;
    ShapeBuilder shapes(part, kLinePixels * pixel, Roundness::of(0), false);
    const auto corner = [&](int n) {
      const Vec3 &low = layer.box.min, &high = layer.box.max;
      return space.placed({n & 1 ? high.x : low.x, n & 2 ? high.y : low.y, n & 4 ? high.z : low.z});
    };
    for (int n = 0; n < 8; ++n)
      for (const int bit : {1, 2, 4})
        if (!(n & bit)) shapes.add_tube(corner(n), corner(n | bit));
    shapes.finish();
    parts.push_back(std::move(part));
  }
}

DrawnPart edge_lines(const DrawnPart& part, std::span<const std::array<std::uint32_t, 2>> edges, float pixel) {
  DrawnPart lines;
  lines.color = linear_of(kLineColor);
  lines.opacity = 1;
  lines.lit = false;
  lines.casts_shadow = false;
  ShapeBuilder shapes(lines, kLinePixels * pixel, Roundness::of(0), false);
  shapes.reserve(0, edges.size());
  for (const auto& [a, b] : edges) shapes.add_tube(part.places[a], part.places[b]);
  shapes.finish();
  return lines;
}

namespace {

// A vertex has a place, a point on the picture, and often a normal and a value; a triangle its corners and its number
// in the bins.
constexpr double kDrawnVertexBytes = sizeof(Float3) * 2 + sizeof(ScreenPoint) + sizeof(float) + 1;
constexpr double kDrawnTriangleBytes = sizeof(Triangle) + 4 * sizeof(std::uint32_t);

double bytes_of(std::size_t count, Roundness::Size size) {
  return static_cast<double>(count) * (kDrawnVertexBytes * static_cast<double>(size.vertices) +
                                       kDrawnTriangleBytes * static_cast<double>(size.triangles));
}

}  // namespace

std::size_t bytes_of_lines(std::size_t edges) {
  return static_cast<std::size_t>(bytes_of(edges, Roundness::of(0).tube()));
}

std::size_t bytes_of_parts(const Drawing& drawing, const UnitSpace& space, float pixel) {
  constexpr double kSide = 3 * sizeof(std::uint32_t);  // of a triangle, while edges are looked for
  double bytes = 0;
  for (const MeshLayer& layer : drawing.meshes) {
    const auto triangles = static_cast<double>(layer.mesh.triangles.size());
    bytes += kDrawnVertexBytes * static_cast<double>(layer.mesh.vertices.size()) + kDrawnTriangleBytes * triangles;
    if (layer.edges) bytes += 3 * kSide * triangles;
    if (!drawing.slices.empty()) bytes += (kDrawnVertexBytes + kDrawnTriangleBytes) * triangles;
  }
  const auto add_balls = [&](std::size_t count, float radius) {
    bytes += bytes_of(count, Roundness::of(radius / pixel).ball());
  };
  for (const BandLayer& band : drawing.bands) {
    add_balls(count_of(band), radius_of(band, space));
  }
  for (const PointLayer& layer : drawing.points)
    add_balls(layer.points.size(), radius_in(space, layer.radius, kPointPixels * pixel));
  for (const PathLayer& layer : drawing.paths) {
    const float radius = radius_in(space, layer.radius, kPathPixels * pixel);
    add_balls(layer.points.size(), radius);
    bytes += bytes_of(layer.points.size(), Roundness::of(radius / pixel).tube());
  }
  return static_cast<std::size_t>(std::min(bytes, 0x1p62));
}

}  // namespace standoff
