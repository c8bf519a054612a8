// SPDX-License-Identifier: Apache-2.0
// Surfaces of fields, and of meshes: of the field that a mesh needs, with what the mesh itself says of its surface.
#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/execution.h"
#include "core/guarded.h"
#include "core/number_text.h"
#include "core/threads.h"
#include "standoff/error.h"
#include "standoff/points.h"
#include "standoff/surface.h"
#include "surface/extract.h"

namespace standoff {
namespace {

constexpr const char* kWhatToDo = "take fewer samples or a larger spacing, or provide more memory";

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

// Where dual contouring looks for the surface at a level.
HermiteSource mesh_source(MeshView mesh, const SignOptions& sign, const IsoOptions& options, double level) {
  const bool is_shell = sign.method == SignMethod::shell;
  MeshOffset offset;
  offset.distance = is_shell ? level + sign.shell / 2 : std::abs(level);
  offset.inside = !is_shell && level < 0;
  // Made when it is first asked: dual contouring alone does.
  const auto query = std::make_shared<std::optional<MeshQuery>>();
  offset.closest = [mesh, query,
                    execution = Execution{.threads = options.execution.threads}](std::span<const Vec3> points) {
    if (!*query) query->emplace(mesh, MeshQueryOptions{.execution = execution});
    std::vector<ClosestPoint> found(points.size());
    (*query)->closest(points, found, execution);
    return found;
  };
  if (offset.distance > 0)
    return {[offset](const Blocks& blocks, const EdgePoints& points, std::span<HermitePoint> data,
                     ProgressMeter& progress) { hermite_of_offset(blocks, points, offset, data, progress); },
            kMeshTolerance};
  return {[mesh, closest = offset.closest](const Blocks& blocks, const EdgePoints& points, std::span<HermitePoint> data,
                                           ProgressMeter& progress) {
            hermite_of_mesh(blocks, points, mesh, closest, data, progress);
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
    extract(
        field, options, [](double) { return field_source(); }, 0, result, progress);
    finish(options, result);
  });
  return result;
} catch (...) {
  throw_as_error("isosurface", kWhatToDo);
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
    extract(
        computed.field, options, [&](double level) { return mesh_source(mesh, sign, options, level); }, kFieldShare,
        result, progress);
    finish(options, result);
  });
  return result;
} catch (...) {
  throw_as_error("isosurface", kWhatToDo);
}

}  // namespace standoff
