// SPDX-License-Identifier: Apache-2.0
// What a picture is made of: triangles in the unit space, and how they look.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "render/camera.h"
#include "render/float3.h"
#include "render/slice_texture.h"
#include "standoff/axis.h"
#include "standoff/mesh_view.h"

namespace standoff {

/// Triangles that look alike.
struct DrawnPart {
  DrawnPart() = default;
  DrawnPart(DrawnPart&&) = default;
  DrawnPart& operator=(DrawnPart&&) = default;
  DrawnPart(const DrawnPart&) = delete;  // `triangles` may be a view of `own`
  DrawnPart& operator=(const DrawnPart&) = delete;
  ~DrawnPart() = default;

  std::vector<Float3> places;  ///< of the vertices, in the unit space
  TriangleArray triangles;     ///< the caller's, or `own`
  std::vector<Triangle> own;
  std::vector<Float3> normals;  ///< unit normals of the vertices; empty: flat
  std::vector<float> values;    ///< a number for each vertex that colors it; empty: `color`
  Float3 color{1, 1, 1};        ///< linear light
  float opacity = 1;            ///< of a slice: where its values are not negative; elsewhere it is opaque
  bool lit = true;              ///< false: shown in its color, whatever the light
  bool casts_shadow = true;
  bool moves = false;  ///< stands elsewhere in other pictures of the same stage
  /// Colors each pixel by a plane's value there, if not null.
  std::shared_ptr<const SliceTexture> slice;
  std::vector<std::array<float, 2>> on_slice;  ///< of the vertices: samples to the right and up
  std::vector<char> unused;  ///< 1 for vertices that no triangle uses, which may be anything; empty: none

  void use_own() { triangles = own; }
  bool is_used(std::size_t vertex) const { return unused.empty() || !unused[vertex]; }
};

}  // namespace standoff
