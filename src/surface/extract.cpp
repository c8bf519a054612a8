// SPDX-License-Identifier: Apache-2.0
#include "surface/extract.h"

#include <cmath>
#include <span>
#include <utility>

#include "core/number_text.h"
#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/diagnosis/self_intersections.h"
#include "standoff/error.h"
#include "surface/blocks.h"
#include "surface/edge_points.h"
#include "surface/marching_cubes.h"

namespace standoff {
namespace {

// Normals by differences are off by some hundredths: planes at angles below 25 degrees are taken for one.
constexpr double kLevelTolerance = 0.05;

// A field holds no surface of values that it is clamped to.
void expect_within(const DistanceField& field, double level) {
  if (std::abs(level) < static_cast<double>(static_cast<float>(field.thickness()))) return;
  throw Error(ErrorCode::usage, "isosurface: a surface at " + number_text(level) +
                                    " is not within the field's thickness of " + number_text(field.thickness()) +
                                    "; compute the field with a larger thickness");
}

void add_surface(const DistanceField& field, double level, const IsoOptions& options, const HermiteSource& source,
                 double from, double to, MemoryBudget& budget, IsoResult& result, ProgressMeter& progress) {
  MemoryShare memory(budget);
  const EdgePoints points(field.grid(), level, options.coordinates);
  const Size3 tiles = field.tile_count();
  const double middle = from + 0.4 * (to - from);
  progress.stage("find", 2 * tiles.y * tiles.z, from, middle);
  memory.take(InsideBits::bytes_for(field));
  const InsideBits inside(field, level, progress);
  Blocks blocks(inside, memory, progress);
  const bool dual = options.method == IsoMethod::dual;
  progress.stage("surface", (dual ? 5 : 2) * std::ssize(blocks.all()), middle, to);
  if (dual)
    contour_dually(blocks, points, source, memory, result.mesh, result.report, progress);
  else
    march_cubes(blocks, points, memory, result.mesh, result.report, progress);
  result.report.floats = points.are_floats();
  result.report.clearance = points.clearance();
}

std::int64_t count_components(const Mesh& mesh) {
  DisjointSets sets(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    sets.join(t[0], t[1], false);
    sets.join(t[0], t[2], false);
  }
  std::int64_t components = 0;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) components += sets.find(v).set == v;
  return components;
}

}  // namespace

void validate(const IsoOptions& options, const Grid& grid) {
  if (options.memory_limit < 0)
    throw Error(ErrorCode::usage, "isosurface: the memory limit is negative; give bytes, or zero for none");
  if (!std::isfinite(options.at))
    throw Error(ErrorCode::usage, "isosurface: the value on the surface is not finite; give a distance");
  if (!(options.wall >= 0) || !std::isfinite(options.wall))
    throw Error(ErrorCode::usage, "isosurface: a wall of " + number_text(options.wall) +
                                      " makes no sense; give a positive thickness, or 0 for none");
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

HermiteSource field_source() {
  return {[](const Blocks& blocks, const EdgePoints& points, std::span<HermitePoint> data, MemoryBudget&,
             ProgressMeter& progress) { hermite_of_field(blocks, points, data, progress); },
          kLevelTolerance};
}

void extract(const DistanceField& field, const IsoOptions& options,
             const std::function<HermiteSource(double level)>& source_of, double from, MemoryBudget& budget,
             IsoResult& result, ProgressMeter& progress) {
  const double inner = options.at - options.wall;
  expect_within(field, options.at);
  if (options.wall > 0) expect_within(field, inner);
  const double middle = options.wall > 0 ? (1 + from) / 2 : 1;
  add_surface(field, options.at, options, source_of(options.at), from, middle, budget, result, progress);
  if (options.wall > 0) {
    const std::size_t outer = result.mesh.triangles.size();
    const std::int64_t capped = result.report.capped;
    add_surface(field, inner, options, source_of(inner), middle, 1, budget, result, progress);
    if (result.report.capped > capped)
      throw Error(
          ErrorCode::usage,
          "isosurface: the hollow reaches the border of the grid, where it would have no wall; take a grid that "
          "holds the whole solid");
    for (Triangle& triangle : std::span(result.mesh.triangles).subspan(outer)) std::swap(triangle[1], triangle[2]);
  }
  progress.stage("done", 1, 1, 1);
}

void finish(const IsoOptions& options, IsoResult& result) {
  IsoReport& report = result.report;
  report.triangles = std::ssize(result.mesh.triangles);
  report.vertices = std::ssize(result.mesh.vertices);
  report.examined = options.examine;
  if (!options.examine || result.mesh.triangles.empty()) return;
  report.components = count_components(result.mesh);
  constexpr std::int64_t kMostPairs = 1'000'000, kTestsPerTriangle = 1000;
  ProgressMeter progress(options.progress);  // the rest of the work is done
  const SelfIntersections found =
      find_self_intersections(result.mesh, MeshEdges(result.mesh, progress),
                              {kMostPairs, kTestsPerTriangle * (report.triangles + 1000), 1, 1}, progress);
  report.self_intersections = found.pairs;
  report.intersections_known = found.complete;
}

}  // namespace standoff
