// SPDX-License-Identifier: Apache-2.0
// Pictures in three dimensions: meshes, slices of fields, points, paths and boxes (docs/render.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "standoff/axis.h"
#include "standoff/color.h"
#include "standoff/colormap.h"
#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/mesh.h"

namespace standoff {

/// Size, viewpoint and quality of a picture. It shows everything that is drawn, unless `zoom` is more than 1.
struct PictureOptions {
  int width = 1280;           ///< pixels, 16 to 8192
  int height = 960;           ///< pixels, 16 to 8192
  double azimuth_deg = 35;    ///< the eye's angle about the up axis; 0: it looks along +y (z up) or -z (y up)
  double elevation_deg = 25;  ///< the eye's height above the horizon, -90 to 90
  bool perspective = true;    ///< false: parallel rays
  /// The axis that points up. None: the first that a mesh layer or a field's provenance names; else up_axis() of the
  /// first mesh; else z.
  std::optional<Axis> up = {};
  double zoom = 1;  ///< enlarges the picture about its centre, 0.01 to 100
  int samples = 4;  ///< per pixel, at which triangles are seen: 1, 2, 4, 8 or 16
  Background background = Background::white;
  bool shadows = true;  ///< soft shadows and ambient occlusion, from a coarse distance field of what is opaque
  bool legend = true;   ///< a bar of colors with numbers, if colors stand for numbers
  bool axes = false;    ///< a small triad of the axes in the lower left corner
  int threads = 0;      ///< as in Execution: the picture has the same bytes for any number
  std::int64_t memory_limit =
      0;  ///< bytes that drawing may take, checked before the work; 0: default_memory_limit(); negative: no limit
};

enum class Shading {
  smooth,  ///< the normals of neighbouring triangles are blended, unless the edge between them is sharp. Meshes with
           ///< more triangles than the picture has pixels are drawn flat: it would not be seen
  flat,    ///< each triangle shows its own normal
};

/// A mesh. Numbers for its vertices become colors by the drawing's colormap, as in the other layers.
struct MeshLayer {
  MeshView mesh;  ///< either orientation; both sides look alike
  Color color{170, 184, 204};
  double opacity = 1;  ///< 0 to 1; what is behind shows through
  Shading shading = Shading::smooth;
  bool edges = false;  ///< draw lines along sharp and open edges
  /// Unit normals of the vertices, for smooth shading; empty: those of the triangles around each, blended.
  std::span<const Vec3> normals = {};
  /// A number for each vertex that colors it, world units; empty: `color`.
  std::span<const double> values = {};
  std::optional<Axis> up = {};  ///< the mesh's axis that points up, if that is known (MeshReadReport::up)
};

/// A plane of a field, with contour lines; parts beyond the band are grey.
struct SliceLayer {
  const DistanceField* field = nullptr;
  Axis axis = Axis::y;         ///< the axis the plane is perpendicular to
  double at = 0.5;             ///< the plane of samples nearest to this share of the axis: 0 is the first, 1 the last
  bool cuts = true;            ///< whether meshes and samples on the eye's side of the plane are left out
  double outside_opacity = 1;  ///< 0 to 1: of the plane where values are not negative; less shows what is behind
};

/// The samples of a field's band, as small balls in the colors of their values.
struct BandLayer {
  const DistanceField* field = nullptr;
  double within = std::numeric_limits<double>::infinity();  ///< only samples whose magnitude is less, world units
};

/// Points as balls.
struct PointLayer {
  std::span<const Vec3> points;
  Color color{214, 39, 40};
  double radius = 0;                    ///< world units; 0: a few pixels
  std::span<const double> values = {};  ///< a number for each point that colors it; empty: `color`
};

/// Polylines as tubes.
struct PathLayer {
  std::span<const Vec3> points;
  std::span<const std::size_t> starts = {};  ///< the first point of each line, ascending; empty: one line of all points
  Color color{31, 119, 180};
  double radius = 0;                    ///< world units; 0: a few pixels
  std::span<const double> values = {};  ///< a number for each point that colors it; empty: `color`
};

/// The edges of a box.
struct BoxLayer {
  Box box;
  Color color{110, 116, 126};
};

/// What a picture shows. Everything is drawn in the same space, nearer things in front of others. Spans and fields must
/// outlive the drawing.
struct Drawing {
  std::vector<MeshLayer> meshes = {};
  std::vector<SliceLayer> slices = {};
  std::vector<BandLayer> bands = {};
  std::vector<PointLayer> points = {};
  std::vector<PathLayer> paths = {};
  std::vector<BoxLayer> boxes = {};
  Colormap colormap =
      Colormap::automatic;  ///< of all numbers; automatic: diverging if a field has a sign or one of them is negative
  std::string quantity = "distance";  ///< what the numbers are, and their unit, in UTF-8: above the legend
};

/// Draws a picture on the CPU and writes it as PNG; the file appears whole or not at all. The picture has the same
/// pixels for any number of threads, and on any machine. Points, values and samples that are not finite are left out.
/// Errors: input (mesh), usage (options, nothing to draw, spans whose lengths differ, a slice without field, or built
/// without libpng), limit (memory), output.
STANDOFF_API void write_picture(const std::filesystem::path& path, const Drawing& drawing,
                                const PictureOptions& options = {}, Existing existing = Existing::replace);

/// The same from `count` directions, 1 to 720, evenly around the up axis, beginning at options.azimuth_deg. All
/// pictures have the same scale. They get their names, those of turntable_file(), when all are drawn: before that,
/// nothing is replaced.
STANDOFF_API void write_turntable(const std::filesystem::path& path, const Drawing& drawing, int count,
                                  const PictureOptions& options = {}, Existing existing = Existing::replace);

/// What picture `n` of a turntable is called: NAME-000.png, NAME-001.png and so on, for a `path` of NAME.png.
STANDOFF_API std::filesystem::path turntable_file(const std::filesystem::path& path, int n);

/// Draws a single mesh. Errors: as write_picture.
STANDOFF_API void write_mesh_png(const std::filesystem::path& path, MeshView mesh, const PictureOptions& options = {},
                                 Existing existing = Existing::replace);

}  // namespace standoff
