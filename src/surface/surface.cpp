// SPDX-License-Identifier: Apache-2.0
// Surfaces of fields; and surfaces of meshes, from a field that is computed for them and from the mesh itself.
#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/guarded.h"
#include "core/memory.h"
#include "core/number_text.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/diagnosis/self_intersections.h"
#include "standoff/error.h"
#include "standoff/points.h"
#include "standoff/surface.h"
#include "surface/blocks.h"
#include "surface/methods.h"
#include "surface/vertices.h"

namespace standoff {
namespace {

// Throws Error{usage} for options that make no sense on this grid.
void validate(const SurfaceOptions& options, const Grid& grid) {
  if (!std::isfinite(options.at))
    throw Error(ErrorCode::usage, "surface: the value on the surface is not finite; give a distance");
  if (!(options.wall >= 0) || !std::isfinite(options.wall))
    throw Error(ErrorCode::usage, "surface: a wall of " + number_text(options.wall) +
                                      " makes no sense; give a positive thickness, or 0 for none");
  if (options.wall > 0 && options.wall < grid.max_spacing())
    throw Error(ErrorCode::usage, "surface: a wall of " + number_text(options.wall) +
                                      " is thinner than the spacing of " + number_text(grid.max_spacing()) +
                                      ", so that its surfaces could intersect; take a smaller spacing");
  if (options.method != SurfaceMethod::marching_cubes && options.method != SurfaceMethod::dual)
    throw Error(ErrorCode::usage, "surface: there is no such method; take marching_cubes or dual");
  if (options.coordinates != Coordinates::automatic && options.coordinates != Coordinates::single &&
      options.coordinates != Coordinates::full)
    throw Error(ErrorCode::usage, "surface: there are no such coordinates; take automatic, single or full");
}

// The error of normals by differences is some hundredths: planes at angles below 25 degrees count as one.
constexpr double kLevelTolerance = 0.05;

// Throws Error{usage} unless the level is below the thickness: the field has no surface at clamped values.
void expect_within(const DistanceField& field, double level) {
  if (std::abs(level) < static_cast<double>(static_cast<float>(field.thickness()))) return;
  throw Error(ErrorCode::usage, "surface: a surface at " + number_text(level) +
                                    " is not within the field's thickness of " + number_text(field.thickness()) +
                                    "; compute the field with a larger thickness");
}

void add_surface(const DistanceField& field, double level, const SurfaceOptions& options, const HermiteSource& source,
                 double from, double to, MemoryBudget& budget, SurfaceResult& result, ProgressMeter& progress) {
  MemoryShare memory(budget);
  const EdgePoints points(field.grid(), level, options.coordinates);
  const Size3 tiles = field.tile_count();
  const double middle = from + 0.4 * (to - from);
  progress.stage("find", 2 * tiles.y * tiles.z, from, middle);
  memory.take(InsideBits::bytes_for(field));
  const InsideBits inside(field, level, progress);
  Blocks blocks(inside, memory, progress);
  const bool dual = options.method == SurfaceMethod::dual;
  progress.stage("surface", (dual ? 5 : 2) * std::ssize(blocks.all()), middle, to);
  if (dual)
    contour_dually(blocks, points, source, memory, result.mesh, result.report, progress);
  else
    result.report.ambiguous_faces +=
        march_cubes(blocks, kAllLayers, points, memory, result.mesh, result.report, progress) / 2;
  result.report.floats = points.are_floats();
  result.report.clearance = points.clearance();
}

// The source for a field without a mesh.
HermiteSource field_source() {
  return {[](const Blocks& blocks, const EdgePoints& points, std::span<HermitePoint> data, MemoryBudget&,
             ProgressMeter& progress) { hermite_of_field(blocks, points, data, progress); },
          kLevelTolerance};
}

// Adds the surface at options.at, and the surface at options.at - options.wall if there is a wall. `source_of` returns
// the source of normals for a level. Reports progress from `from` to 1. Runs on the threads of the calling TBB arena.
void extract(const DistanceField& field, const SurfaceOptions& options,
             const std::function<HermiteSource(double level)>& source_of, double from, MemoryBudget& budget,
             SurfaceResult& result, ProgressMeter& progress) {
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
      throw Error(ErrorCode::usage,
                  "surface: the hollow reaches the border of the grid, where it would have no wall; take a grid that "
                  "holds the whole solid");
    for (Triangle& triangle : std::span(result.mesh.triangles).subspan(outer)) std::swap(triangle[1], triangle[2]);
  }
  progress.stage("done", 1, 1, 1);
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

// Fills the counts of the report.
void finish(const SurfaceOptions& options, SurfaceResult& result) {
  SurfaceReport& report = result.report;
  report.triangles = std::ssize(result.mesh.triangles);
  report.vertices = std::ssize(result.mesh.vertices);
  report.examined = options.examine;
  if (!options.examine || result.mesh.triangles.empty()) return;
  report.components = count_components(result.mesh);
  constexpr std::int64_t kMostPairs = 1'000'000, kTestsPerTriangle = 1000;
  ProgressMeter progress(options.progress);  // all other work is done
  const SelfIntersections found =
      find_self_intersections(result.mesh, MeshEdges(result.mesh, progress),
                              {kMostPairs, kTestsPerTriangle * (report.triangles + 1000), 1, 1}, progress);
  report.self_intersections = found.pairs;
  report.intersections_known = found.complete;
}

constexpr const char* kCoarserGrid = "take fewer samples or a larger spacing, or provide more memory";

// Positions and normals of a mesh are exact: planes at angles of a degree and more count as different.
constexpr double kMeshTolerance = 1e-4;

// The field's share of the progress.
constexpr double kFieldShare = 0.6;

// Computes the field that reaches as far as the surface, its cells, and the samples around them.
ComputeResult field_of(MeshView mesh, const Grid& grid, const SurfaceOptions& options) {
  ComputeOptions wanted{
      .sign = options.sign, .execution = options.execution, .memory_limit = options.memory_limit, .hash_mesh = false};
  std::exception_ptr thrown;  // an exception of the caller's callback, which passes unchanged
  if (options.progress)
    wanted.progress = [&](const Progress& progress) {
      try {
        return options.progress({progress.stage, kFieldShare * progress.fraction});
      } catch (...) {
        thrown = std::current_exception();
        throw;
      }
    };
  const double reach = std::max(std::abs(options.at), std::abs(options.at - options.wall));
  try {
    return compute(mesh, grid, reach + 2 * length(grid.spacing), wanted);
  } catch (...) {
    if (thrown) throw FromCallback{thrown};
    throw;
  }
}

// A function for closest points of the mesh. Its query is made on first use: only dual contouring uses it.
ClosestFunction closest_in(MeshView mesh, const SurfaceOptions& options, MemoryBudget& budget) {
  const auto query = std::make_shared<std::optional<MeshQuery>>();
  return [mesh, query, &budget,
          execution = Execution{.threads = options.execution.threads}](std::span<const Vec3> points) {
    if (!*query) {
      query->emplace(mesh, MeshQueryOptions{.sign = {SignMethod::none}, .execution = execution});
      budget.take(static_cast<std::size_t>((*query)->memory_bytes()));
    }
    std::vector<ClosestPoint> found(points.size());
    (*query)->closest(points, found, {.execution = execution});
    return found;
  };
}

// The source of dual contouring for the surface at a level.
HermiteSource mesh_source(MeshView mesh, const SignOptions& sign, const ClosestFunction& closest, double level) {
  const bool is_shell = sign.method == SignMethod::shell;
  MeshOffset offset{.closest = closest,
                    .distance = is_shell ? level + sign.shell / 2 : std::abs(level),
                    .inside = !is_shell && level < 0};
  if (offset.distance > 0)
    return {[offset](const Blocks& blocks, const EdgePoints& points, std::span<HermitePoint> data, MemoryBudget& memory,
                     ProgressMeter& progress) { hermite_of_offset(blocks, points, offset, data, memory, progress); },
            kMeshTolerance};
  return {[mesh, closest](const Blocks& blocks, const EdgePoints& points, std::span<HermitePoint> data,
                          MemoryBudget& memory, ProgressMeter& progress) {
            hermite_of_mesh(blocks, points, mesh, closest, data, memory, progress);
          },
          kMeshTolerance};
}

// Reads slices of a field, and checks that they are what was asked for.
DistanceField slices_of(const Grid& grid, double thickness, const SliceReader& read, std::int64_t first,
                        std::int64_t count) {
  DistanceField field = call_back(read, first, count);
  if (field.grid() != grid.window({0, 0, first}, {grid.size.x, grid.size.y, count}) || field.thickness() != thickness)
    throw Error(ErrorCode::usage, "surface: " + std::to_string(count) + " slices from slice " + std::to_string(first) +
                                      " on were asked for, and others came; give that window of the field");
  return field;
}

// Adds the surface at a level of a field that is read layer by layer. Cells of a layer have vertices of the next one,
// whose numbers depend on all samples of its blocks, and on the first ones behind these.
void add_surface_of_slices(const Grid& grid, double thickness, const SliceReader& read, double level,
                           const SurfaceOptions& options, std::int64_t slices, MemoryBudget& budget,
                           SurfaceResult& result, ProgressMeter& progress) {
  constexpr std::int64_t kOverlap = 2 * kTileSide;
  std::int64_t ambiguous = 0;
  for (std::int64_t first = 0; first < grid.size.z; first += slices) {
    const std::int64_t end = std::min(first + slices, grid.size.z), read_to = std::min(end + kOverlap, grid.size.z);
    MemoryShare memory(budget);
    const DistanceField field = slices_of(grid, thickness, read, first, read_to - first);
    memory.take(static_cast<std::size_t>(field.memory_bytes()) + InsideBits::bytes_for(field));
    expect_within(field, level);
    const EdgePoints points(field.grid(), grid, level, options.coordinates);
    const InsideBits inside(field, level, progress);
    Blocks blocks(inside, memory, progress);
    const BlockLayers own{first == 0 ? kAllLayers.begin : 0,
                          end == grid.size.z ? kAllLayers.end : (end - first) / kTileSide};
    ambiguous += march_cubes(blocks, own, points, memory, result.mesh, result.report, progress);
    result.report.floats = points.are_floats();
    result.report.clearance = points.clearance();
  }
  result.report.ambiguous_faces += ambiguous / 2;
}

}  // namespace

SurfaceResult surface(const Grid& grid, double thickness, const SliceReader& read, const SurfaceOptions& options,
                      std::int64_t slice_samples) try {
  validate("surface", options.execution, Runs::on_the_cpu);
  validate(grid);
  validate(options, grid);
  if (options.method != SurfaceMethod::marching_cubes || options.wall > 0)
    throw Error(ErrorCode::usage,
                "surface: of slices there are no walls and no dual contouring; take marching cubes, or a whole field");
  if (slice_samples < 1) throw Error(ErrorCode::usage, "surface: slices without samples; give 1 or more");
  const std::int64_t layers = std::max<std::int64_t>(1, slice_samples / (grid.size.x * grid.size.y) / kTileSide);
  SurfaceResult result;
  Threads(options.execution.threads).run([&] {
    ProgressMeter progress(options.progress);
    progress.stage("surface", 1, 0, 1);
    MemoryBudget budget("surface", memory_limit_of(options.memory_limit), kCoarserGrid);
    add_surface_of_slices(grid, thickness, read, options.at, options, kTileSide * std::min(layers, grid.size.z), budget,
                          result, progress);
    progress.stage("done", 1, 1, 1);
    finish(options, result);
  });
  return result;
} catch (...) {
  throw_as_error("surface", kCoarserGrid);
}

SurfaceResult surface(const DistanceField& field, const SurfaceOptions& options) try {
  validate("surface", options.execution, Runs::on_the_cpu);
  validate(options, field.grid());
  SurfaceResult result;
  Threads(options.execution.threads).run([&] {
    ProgressMeter progress(options.progress);
    MemoryBudget budget("surface", memory_limit_of(options.memory_limit), kCoarserGrid);
    extract(
        field, options, [](double) { return field_source(); }, 0, budget, result, progress);
    finish(options, result);
  });
  return result;
} catch (...) {
  throw_as_error("surface", kCoarserGrid);
}

SurfaceResult surface(MeshView mesh, const Grid& grid, const SurfaceOptions& options) try {
  validate(grid);
  validate(options, grid);
  const ComputeResult computed = field_of(mesh, grid, options);
  SurfaceResult result{.report = {.sign = computed.report.sign}};
  if (computed.report.sign.method == SignMethod::none && !(options.at - options.wall > 0)) {
    const std::string why = computed.report.sign.why;
    throw Error(ErrorCode::input, "surface: there is no inside to make a surface of at " +
                                      number_text(options.at - options.wall) + (why.empty() ? "" : ": " + why) +
                                      "; choose a sign method, or a positive distance from the mesh");
  }
  Threads(options.execution.threads).run([&] {
    ProgressMeter progress(options.progress);
    MemoryBudget budget("surface", memory_limit_of(options.memory_limit), kCoarserGrid);
    budget.take(static_cast<std::size_t>(computed.field.memory_bytes()));
    const ClosestFunction closest = closest_in(mesh, options, budget);
    extract(
        computed.field, options, [&](double level) { return mesh_source(mesh, options.sign, closest, level); },
        kFieldShare, budget, result, progress);
    // Inside of a mesh no part of it is near the surface.
    if (options.at >= 0) find_lost_parts(mesh, computed.field, options.at, budget, result.report, progress);
    finish(options, result);
  });
  return result;
} catch (...) {
  throw_as_error("surface", kCoarserGrid);
}

}  // namespace standoff
