// SPDX-License-Identifier: Apache-2.0
// Surfaces of fields, and of meshes: of the field that a mesh needs, with what the mesh itself says of its surface.
#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/guarded.h"
#include "core/number_text.h"
#include "core/threads.h"
#include "standoff/error.h"
#include "standoff/points.h"
#include "standoff/surface.h"
#include "surface/extract.h"

namespace standoff {
namespace {

constexpr const char* kCoarserGrid = "take fewer samples or a larger spacing, or provide more memory";

// Positions and normals of a mesh are exact: planes at angles of a degree and more are told apart.
constexpr double kMeshTolerance = 1e-4;

// How much of the whole time the field takes.
constexpr double kFieldShare = 0.6;

// Computes the field that reaches as far as the surface, its cells, and the samples around them.
ComputeResult field_of(MeshView mesh, const Grid& grid, const SignOptions& sign, const IsoOptions& options) {
  ComputeOptions wanted;
  wanted.sign = sign;
  wanted.execution = options.execution;
  wanted.hash_mesh = false;
  wanted.memory_limit = options.memory_limit;
  std::exception_ptr thrown;  // by the caller's callback: it passes unchanged
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

// Closest points of the mesh. What finds them is made when it is first asked for: dual contouring alone does.
ClosestFunction closest_in(MeshView mesh, const IsoOptions& options, MemoryBudget& budget) {
  const auto query = std::make_shared<std::optional<MeshQuery>>();
  return [mesh, query, &budget,
          execution = Execution{.threads = options.execution.threads}](std::span<const Vec3> points) {
    if (!*query) {
      query->emplace(mesh, MeshQueryOptions{.execution = execution});
      budget.take(static_cast<std::size_t>((*query)->memory_bytes()));
    }
    std::vector<ClosestPoint> found(points.size());
    (*query)->closest(points, found, execution);
    return found;
  };
}

// Where dual contouring looks for the surface at a level.
HermiteSource mesh_source(MeshView mesh, const SignOptions& sign, const ClosestFunction& closest, double level) {
  const bool is_shell = sign.method == SignMethod::shell;
  MeshOffset offset;
  offset.closest = closest;
  offset.distance = is_shell ? level + sign.shell / 2 : std::abs(level);
  offset.inside = !is_shell && level < 0;
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

}  // namespace

IsoResult isosurface(const DistanceField& field, const IsoOptions& options) try {
  validate("isosurface", options.execution, Runs::on_the_cpu);
  validate(options, field.grid());
  IsoResult result;
  Threads(options.execution.threads).run([&] {
    ProgressMeter progress(options.progress);
    MemoryBudget budget("isosurface", options.memory_limit, kCoarserGrid);
    extract(
        field, options, [](double) { return field_source(); }, 0, budget, result, progress);
    finish(options, result);
  });
  return result;
} catch (...) {
  throw_as_error("isosurface", kCoarserGrid);
}

IsoResult isosurface(MeshView mesh, const Grid& grid, const SignOptions& sign, const IsoOptions& options) try {
  validate(grid);
  validate(options, grid);
  const ComputeResult computed = field_of(mesh, grid, sign, options);
  IsoResult result;
  result.report.sign = computed.report.sign;
  if (computed.report.sign.method == SignMethod::none && !(options.at - options.wall > 0)) {
    const std::string why = computed.report.sign.why;
    throw Error(ErrorCode::input, "isosurface: there is no inside to make a surface of at " +
                                      number_text(options.at - options.wall) + (why.empty() ? "" : ": " + why) +
                                      "; choose a sign method, or a positive distance from the mesh");
  }
  Threads(options.execution.threads).run([&] {
    ProgressMeter progress(options.progress);
    MemoryBudget budget("isosurface", options.memory_limit, kCoarserGrid);
    budget.take(static_cast<std::size_t>(computed.field.memory_bytes()));
    const ClosestFunction closest = closest_in(mesh, options, budget);
    extract(
        computed.field, options, [&](double level) { return mesh_source(mesh, sign, closest, level); }, kFieldShare,
        budget, result, progress);
    finish(options, result);
  });
  return result;
} catch (...) {
  throw_as_error("isosurface", kCoarserGrid);
}

}  // namespace standoff
