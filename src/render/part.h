// SPDX-License-Identifier: Apache-2.0
// What a picture in three dimensions is made of: triangles in the unit space, and how they look. A drawing's layers
// become parts.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "render/camera.h"
#include "render/float3.h"
#include "render/slice.h"
#include "standoff/axis.h"
#include "standoff/mesh_view.h"
#include "standoff/picture.h"

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
  bool exact_normals = false;  ///< light falls on the normals as they are, whatever the triangles
  bool moves = false;          ///< stands elsewhere in other pictures of the same stage
  /// Colors each pixel by a plane's value there, if not null.
  std::shared_ptr<const SliceTexture> slice;
  std::vector<std::array<float, 2>> on_slice;  ///< of the vertices: samples to the right and up
  std::vector<char> unused;  ///< 1 for vertices that no triangle uses, which may be anything; empty: none

  void use_own() { triangles = own; }
  bool is_used(std::size_t vertex) const { return unused.empty() || !unused[vertex]; }
};

/// A part, projected.
struct SeenPart {
  const DrawnPart* part = nullptr;
  std::vector<ScreenPoint> points;  ///< of the vertices
  std::uint32_t first = 0;          ///< the number of its first triangle among those of all parts
};

/// 1 for each vertex that no triangle of a valid mesh uses; empty if there is none.
std::vector<char> unused_vertices(MeshView mesh);
/// The box around all vertices that are used.
Box bounds_of_used(MeshView mesh, const std::vector<char>& unused);

/// A valid mesh in the unit space, without normals. `layer` must outlive the part, unless it is cut.
DrawnPart part_of(const MeshLayer& layer, const UnitSpace& space, std::vector<char> unused);
/// Gives each vertex the mean of its triangles' normals, weighted by area: the same bits for any number of threads.
void smooth(DrawnPart& part);

/// The points whose coordinate along an axis is at most `most`.
struct HalfSpace {
  Axis axis = Axis::z;
  float most = 0;
  bool reversed = false;  ///< at least `most`

  float beyond(Float3 p) const {
    const float at = axis == Axis::x ? p.x : axis == Axis::y ? p.y : p.z;
    return reversed ? most - at : at - most;
  }
};
/// Leaves out what lies beyond a half space; triangles that cross its plane are cut there.
void cut(DrawnPart& part, const HalfSpace& kept);

/// The edges of a part's triangles where the surface ends, more than two triangles meet, or two at more than 30
/// degrees; as pairs of vertices.
std::vector<std::array<std::uint32_t, 2>> feature_edges(const DrawnPart& part);

/// The finite numbers that a drawing turns into colors.
struct NumberRange {
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  double thickness = least;  ///< of the fields: numbers of this magnitude stand for all beyond
  bool ends_early = false;   ///< whether a few numbers are greater

  bool empty() const { return !(least <= greatest); }
  void include(double value) {
    if (!std::isfinite(value)) return;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
};
NumberRange number_range(const Drawing& drawing);

/// Throws Error{usage} or Error{input} for a drawing that cannot be drawn.
void check(const Drawing& drawing);
/// The box around everything drawn; empty if there is nothing.
Box bounds_of(const Drawing& drawing, const std::vector<std::vector<char>>& unused);

/// Where the plane that a slice shows lies along its axis, world units.
double position_of(const SliceLayer& slice);

/// Add the parts that the layers other than meshes become. `pixel` is about the width of a pixel in the unit space.
void add_slices(const Drawing& drawing, const UnitSpace& space, std::vector<DrawnPart>& parts);
void add_bands(const Drawing& drawing, const UnitSpace& space, float pixel, std::vector<DrawnPart>& parts);
void add_points(const Drawing& drawing, const UnitSpace& space, float pixel, std::vector<DrawnPart>& parts);
void add_paths(const Drawing& drawing, const UnitSpace& space, float pixel, std::vector<DrawnPart>& parts);
void add_boxes(const Drawing& drawing, const UnitSpace& space, float pixel, std::vector<DrawnPart>& parts);
/// Lines along edges of a part; edges are given by their ends.
DrawnPart edge_lines(const DrawnPart& part, std::span<const std::array<std::uint32_t, 2>> edges, float pixel);

/// About how many bytes the parts of a drawing will take, without the lines along edges.
std::size_t bytes_of_parts(const Drawing& drawing, const UnitSpace& space, float pixel);
std::size_t bytes_of_lines(std::size_t edges);

}  // namespace standoff
