// SPDX-License-Identifier: Apache-2.0
// Balls and tubes as triangles.
#pragma once

#include <cstddef>

#include "render/part.h"

namespace standoff {

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

  /// To be called first, with the most that will be added: then no memory is taken twice.
  void reserve(std::size_t balls, std::size_t tubes);
  void add_ball(Float3 center, float value = 0);
  /// Without caps.
  void add_tube(Float3 from, Float3 to, float value_from = 0, float value_to = 0);
  /// To be called when all is added.
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

}  // namespace standoff
