// SPDX-License-Identifier: Apache-2.0
// The parts that layers become: what they take is what was said before.
#include "render/part.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scenes/scenes.h"
#include "standoff/compute.h"

namespace standoff {
namespace {

constexpr float kPixel = 2 / 480.0F;

template <class T>
std::size_t bytes(const std::vector<T>& all) {
  return all.capacity() * sizeof(T);
}

std::size_t bytes(const std::vector<DrawnPart>& parts) {
  std::size_t sum = 0;
  for (const DrawnPart& part : parts)
    sum += bytes(part.places) + bytes(part.own) + bytes(part.normals) + bytes(part.values) + bytes(part.unused);
  return sum;
}

std::vector<Vec3> spiral(int points) {
  std::vector<Vec3> all;
  for (int n = 0; n < points; ++n) all.push_back({std::cos(0.1 * n), std::sin(0.1 * n), 2.0 * n / points - 1});
  return all;
}

// Of balls and tubes of all sizes; more is said for their places on the picture, which come later.
TEST(Layers, TakeNoMoreThanWasSaidAndNotMuchLess) {
  const UnitSpace space(Box{{-1, -1, -1}, {1, 1, 1}});
  const std::vector<Vec3> points = spiral(500);
  const std::vector<double> values(points.size(), 1);
  const DistanceField field =
      compute(scenes::make("sphere", 2000), Grid{{24, 24, 24}, {-1.2, -1.2, -1.2}, {0.1, 0.1, 0.1}}, 0.2,
              {.sign = {SignMethod::none}})
          .field;
  for (const double radius : {0.0, 0.002, 0.02, 0.2})
    for (const bool colored : {false, true})
      for (int layer = 0; layer < 3; ++layer) {
        Drawing drawing;
        const std::span<const double> numbers = colored ? std::span<const double>(values) : std::span<const double>();
        if (layer == 0) drawing.points.push_back({.points = points, .radius = radius, .values = numbers});
        if (layer == 1) drawing.paths.push_back({.points = points, .radius = radius, .values = numbers});
        if (layer == 2) drawing.bands.push_back({.field = &field});
        std::vector<DrawnPart> parts;
        add_points(drawing, space, kPixel, parts);
        add_paths(drawing, space, kPixel, parts);
        add_bands(drawing, space, kPixel, parts);
        const std::size_t said = bytes_of_parts(drawing, space, kPixel);
        EXPECT_LE(bytes(parts), said) << radius << ' ' << layer;
        EXPECT_GE(3 * bytes(parts), said) << radius << ' ' << layer;
      }
}

TEST(Layers, LinesTakeNoMoreThanWasSaid) {
  const Mesh box = scenes::make("box");
  const UnitSpace space(bounds(box));
  const DrawnPart part = part_of({.mesh = box}, space, {});
  const auto edges = feature_edges(part);
  ASSERT_EQ(edges.size(), 12U);
  std::vector<DrawnPart> lines;
  lines.push_back(edge_lines(part, edges, kPixel));
  EXPECT_EQ(lines[0].triangles.size(), 12U * 8);
  EXPECT_LE(bytes(lines), bytes_of_lines(edges.size()));
}

}  // namespace
}  // namespace standoff
