// SPDX-License-Identifier: Apache-2.0
#include "batch/normalize.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "standoff/error.h"

namespace standoff {
namespace {

// Of all corners, not of the box's: the ball around a ball has its radius.
double farthest_corner(MeshView mesh, Vec3 center) {
  double most_sq = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Vec3 d = mesh.corner(t, k) - center;
      most_sq = std::max(most_sq, d.x * d.x + d.y * d.y + d.z * d.z);
    }
  return std::sqrt(most_sq);
}

}  // namespace

Similarity normalization(MeshView mesh, Normalization kind) {
  if (kind == Normalization::none) return {};
  const Box box = bounds(mesh);
  const Vec3 center = box.min + (box.max - box.min) * 0.5;
  const Vec3 sides = box.max - box.min;
  const double extent =
      kind == Normalization::unit_cube ? std::max({sides.x, sides.y, sides.z}) : farthest_corner(mesh, center);
  const double scale = 1 / extent;
  if (!std::isfinite(scale) || !(extent < std::numeric_limits<double>::infinity()))
    throw Error(ErrorCode::input, "mesh: its extent is " + std::to_string(extent) +
                                      ", which no scale brings to 1; repair the mesh, or leave its size as it is");
  return {center, scale};
}

void apply(const Similarity& similarity, Mesh& mesh) {
  for (Vec3& vertex : mesh.vertices) vertex = (vertex - similarity.center) * similarity.scale;
}

}  // namespace standoff
