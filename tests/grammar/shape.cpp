// SPDX-License-Identifier: Apache-2.0
#include "tests/grammar/shape.h"

#include <limits>

namespace standoff::grammar {
namespace {

// Corners on a parabola, in exact integers: convex however many there are. Where a float places them, some that are
// nearly on a line may come to lie on its other side; there, a few of an octagon.
void add_polygon(Choices& c, Shape& shape, bool exact) {
  constexpr double kOctagon[][2] = {{1, 0}, {2, 0}, {3, 1}, {3, 2}, {2, 3}, {1, 3}, {0, 2}, {0, 1}};
  const std::uint32_t corners = 4 + c.below(exact ? 9 : 5);
  const double level = double(c.below(5)) - 2;
  std::vector<std::uint32_t> face;
  for (std::uint32_t k = 0; k < corners; ++k) {
    face.push_back(static_cast<std::uint32_t>(shape.points.size()));
    if (exact)
      shape.points.push_back({double(k), double(k * k), level});
    else
      shape.points.push_back({kOctagon[k][0], kOctagon[k][1], level});
  }
  shape.faces.push_back(face);
}

}  // namespace

float make_coordinate(Choices& c, bool extreme) {
  using L = std::numeric_limits<float>;
  if (extreme && c.one_in(12)) {
    const float numbers[] = {0.0f, -0.0f, L::denorm_min(), -L::min(), 1e30f, -1e30f, 1e-30f, 16777217.0f};
    return c.pick(numbers);
  }
  if (c.one_in(3)) return static_cast<float>(c.below(1u << 24)) / 65536 - 128;
  return (static_cast<float>(c.below(17)) - 8) / 2;
}

Shape make_shape(Choices& c, Polygons polygons, bool extreme) {
  Shape shape;
  const std::uint32_t points = 3 + c.below(c.one_in(16) ? 300 : 12), triangles = 1 + c.below(points * 2);
  for (std::uint32_t n = 0; n < points; ++n) {
    const float x = make_coordinate(c, extreme), y = make_coordinate(c, extreme), z = make_coordinate(c, extreme);
    shape.points.push_back({x, y, z});
  }
  for (std::uint32_t n = 0; n < triangles; ++n)
    shape.faces.push_back({c.below(points), c.below(points), c.below(points)});
  if (polygons == Polygons::none) return shape;
  for (std::uint32_t n = c.below(4); n > 0; --n) add_polygon(c, shape, extreme);
  // Edges and points are no surface.
  if (c.one_in(8)) shape.faces.push_back({0, 1});
  if (c.one_in(8)) shape.faces.push_back({0});
  return shape;
}

void add_triangles(const Shape& shape, std::vector<Corners>& to) {
  for (const auto& face : shape.faces)
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      to.push_back({shape.points[face[0]], shape.points[face[k]], shape.points[face[k + 1]]});
}

}  // namespace standoff::grammar
