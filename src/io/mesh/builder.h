// SPDX-License-Identifier: Apache-2.0
// From the vertices and faces of a file to a mesh: polygons into triangles, equal vertices into one.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "files/file_view.h"
#include "standoff/mesh.h"

namespace standoff {

/// Collects what an indexed format holds. Vertices may come after the faces that use them.
class MeshBuilder {
 public:
  explicit MeshBuilder(const FileView& file) : file_(file) {}

  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;

  /// Adds a polygon. Faces with fewer than three corners are points or edges, not surface, and left out.
  void add_face(std::span<const std::uint32_t> corners);

  /// Checks, triangulates and welds: equal vertices become one, numbered in the order of the file, and vertices that no
  /// triangle uses stay. `where(v)` says where vertex v stands in the file, for messages.
  /// Errors: input when there are no triangles, an index is out of range, a vertex in use is not finite, or a polygon
  /// cannot be triangulated;
  /// limit when there are more than 32-bit numbers can count. The builder is empty afterwards.
  Mesh finish(const std::function<std::string(std::size_t)>& where);

 private:
  void triangulate_polygons(const std::function<std::string(std::size_t)>& where);
  void check_indices() const;
  void check_vertices(const std::function<std::string(std::size_t)>& where) const;

  // Triangles [first, first + count) are the fan of one polygon.
  struct Polygon {
    std::size_t first, count;
  };

  const FileView& file_;
  std::vector<Polygon> polygons_;
};

/// Throws Error{limit} unless 32-bit numbers can count that many vertices and triangles.
void check_counts(const FileView& file, std::uint64_t vertices, std::uint64_t triangles);

/// Throws Error{input}: the file holds no triangles.
[[noreturn]] void fail_no_triangles(const FileView& file);

/// What is said of a vertex with a NaN or infinite coordinate.
inline constexpr const char* kNotFinite =
    "a coordinate is not a finite number; repair the mesh in the program that wrote it";

/// Squares of corners that a mesh with so many corners in its polygons may take: what one polygon of 2^15 corners
/// needs, a few seconds, and 256 for each corner, which real polygons do not come near.
inline double polygon_work(std::size_t corners) { return 0x1p30 + 256 * static_cast<double>(corners); }

/// Triangulates the polygon whose corners are fan[0][0], fan[0][1] and fan[k][2], in order, and replaces the fan: n
/// corners always give n - 2 triangles over the same corners. The polygon is looked at along the axis that its normal
/// (Newell's sum) is closest to. Where no triangle of the fan turns against the normal, as in every convex polygon, the
/// fan stays. Otherwise ears are cut, in the order of the corners; polygons that cross themselves are cut where no ear
/// is left, at the first convex corner. Polygons that are not planar or have no area get some triangulation, always
/// the same one. Cutting ears takes time by the square of the corners, and `work` bounds it: so many squares
/// are taken off it. Returns false, with all unchanged, when the polygon is not convex and has more squares than are
/// left. Requires finite corners.
bool triangulate(std::span<const Vec3> vertices, std::span<Triangle> fan, double& work);

}  // namespace standoff
