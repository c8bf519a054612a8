// SPDX-License-Identifier: Apache-2.0
#include "render/shapes.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace standoff {
namespace {

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

// Points on the unit circle, as fine as their count says: halves of halves of the four corners.
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

}  // namespace

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

void ShapeBuilder::add_tube(Float3 from, Float3 to, float value_from, float value_to) {
  const Float3 along = unit_or(to - from, {});
  if (along.x == 0 && along.y == 0 && along.z == 0) return;
  // Any direction across: away from the axis that the tube is least along.
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

}  // namespace standoff
