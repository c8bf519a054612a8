// SPDX-License-Identifier: Apache-2.0
// The public functions: options, the field that a mesh needs, one surface or two, and what is known of the result.
#include <algorithm>
#include <cmath>
#include <string>

#include "core/execution.h"
#include "core/guarded.h"
#include "core/number_text.h"
#include "core/threads.h"
#include "standoff/error.h"
#include "standoff/surface.h"
#include "surface/blocks.h"
#include "surface/dual_contouring.h"
#include "surface/edge_points.h"
#include "surface/marching_cubes.h"

namespace standoff {
namespace {

// Normals by differences are off by some hundredths: planes at angles below 25 degrees are taken for one.
constexpr double kFieldTolerance = 0.05;
const HermiteSource kOfField{hermite_of_field, kFieldTolerance};

constexpr const char* kWhatToDo = "take fewer samples or a larger spacing, or provide more memory";

void validate(const IsoOptions& options, const Grid& grid) {
  if (!std::isfinite(options.at))
    throw Error(ErrorCode::usage, "isosurface: the value on the surface is not finite; give a distance");
  if (!(options.wall >= 0) || !std::isfinite(options.wall))
    throw Error(ErrorCode::usage, "isosurface: the wall is " + number_text(options.wall) +
                                      " thick; give a positive thickness, or 0 for none");
  if (options.wall > 0 && options.wall < grid.max_spacing())
    throw Error(ErrorCode::usage, "isosurface: a wall of " + number_text(options.wall) +
                                      " is thinner than the spacing of " + number_text(grid.max_spacing()) +
                                      ", so that its surfaces could intersect; take a smaller spacing");
  if (options.method != IsoMethod::marching_cubes && options.method != IsoMethod::dual)
    throw Error(ErrorCode::usage, "isosurface: there is no such method; take marching_cubes or dual");
  if (options.coordinates != Coordinates::automatic && options.coordinates != Coordinates::single &&
      options.coordinates != Coordinates::full)
    throw Error(ErrorCode::usage, "isosurface: there are no such coordinates; take automatic, single or full");
}

// A field holds no surface of values that it is clamped to.
void expect_within(const DistanceField& field, double level) {
  if (std::abs(level) < static_cast<double>(static_cast<float>(field.thickness()))) return;
  throw Error(ErrorCode::usage, "isosurface: a surface at " + number_text(level) +
                                    " is not within the field's thickness of " + number_text(field.thickness()) +
                                    "; compute the field with a larger thickness");
}

void add_surface(const DistanceField& field, double level, const IsoOptions& options, const HermiteSource& source,
                 IsoResult& result, ProgressMeter& progress) {
  expect_within(field, level);
  const EdgePoints points(field.grid(), level, options.coordinates);
  const Size3 tiles = field.tile_count();
  progress.stage("find", tiles.y * tiles.z, 0, 0.4);
  const InsideBits inside(field, level, progress);
  Blocks blocks(inside, progress);
  const bool dual = options.method == IsoMethod::dual;
  progress.stage("surface", (dual ? 5 : 2) * std::ssize(blocks.all()), 0.4, 1);
  if (dual)
    contour_dually(blocks, points, source, result.mesh, result.report, progress);
  else
    march_cubes(blocks, points, result.mesh, result.report, progress);
  result.report.floats = points.are_floats();
  result.report.clearance = points.clearance();
}

void reverse(std::span<Triangle> triangles) {
  for (Triangle& triangle : triangles) std::swap(triangle[1], triangle[2]);
}

}  // namespace

IsoResult isosurface(const DistanceField& field, const IsoOptions& options) try {
  validate("isosurface", options.execution, Runs::on_the_cpu);
  validate(options, field.grid());
  IsoResult result;
  Threads(options.execution.threads).run([&] {
    ProgressMeter progress(options.progress);
    add_surface(field, options.at, options, kOfField, result, progress);
    if (options.wall > 0) {
      const std::size_t outer = result.mesh.triangles.size();
      add_surface(field, options.at - options.wall, options, kOfField, result, progress);
      reverse(std::span(result.mesh.triangles).subspan(outer));
    }
    progress.stage("done", 1, 1, 1);
  });
  result.report.triangles = std::ssize(result.mesh.triangles);
  result.report.vertices = std::ssize(result.mesh.vertices);
  return result;
} catch (...) {
  throw_as_error("isosurface", kWhatToDo);
}

}  // namespace standoff
