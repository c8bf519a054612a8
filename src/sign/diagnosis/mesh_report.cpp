// SPDX-License-Identifier: Apache-2.0
#include "standoff/mesh_report.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/guarded.h"
#include "core/progress.h"
#include "core/threads.h"
#include "sign/diagnosis/components.h"
#include "sign/diagnosis/diagnose.h"
#include "sign/diagnosis/nesting.h"
#include "sign/diagnosis/self_intersections.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// Within it volumes and their moments are finite, and predicates exact.
constexpr double kMostCoordinate = 1e60;

void check(const MeshReportOptions& options) {
  validate("report", options.execution, Runs::on_the_cpu);
  if (!(options.spacing >= 0) || !std::isfinite(options.spacing))
    throw Error(ErrorCode::usage, "report: the spacing must be a finite number, and not negative");
  if (options.most_components < 0 || options.most_intersections < 0 || options.most_intersection_tests < 0)
    throw Error(ErrorCode::usage, "report: a limit is negative");
}

void add_components(const OrientedMesh& mesh, const MeshEdges& edges, const MeshReportOptions& options,
                    ProgressMeter& progress, MeshReport& found) {
  Components components = find_components(mesh, edges);
  progress.check();
  std::vector<Part> parts;
  for (const MeshComponent& component : components.all) parts.push_back({component.bounds, component.solid});
  const Nesting nesting = find_nesting(mesh, components.of, parts);
  found.nesting_known = found.nesting_known && nesting.known;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    components.all[n].depth = nesting.depth[n];
    found.deepest = std::max(found.deepest, nesting.depth[n]);
  }
  found.component_count = static_cast<std::int64_t>(components.all.size());
  std::ranges::sort(components.all, {}, [](const MeshComponent& c) { return std::pair(-c.area, c.first_triangle); });
  if (found.component_count > options.most_components)
    components.all.resize(static_cast<std::size_t>(options.most_components));
  found.components = std::move(components.all);
}

MeshReport examine(MeshView mesh, const MeshReportOptions& options, ProgressMeter& progress) {
  const Box box = bounds(mesh);
  if (!(std::max(max_norm(box.min), max_norm(box.max)) <= kMostCoordinate))
    throw Error(ErrorCode::limit,
                "report: a coordinate is larger than 1e60, where volumes exceed all numbers; scale the mesh");
  progress.stage("edges", 1, 0, 0.1);
  const MeshEdges edges(mesh, progress);
  progress.stage("diagnosis", 1, 0.1, 0.5);
  Diagnosis diagnosis = diagnose(mesh, edges, progress);
  MeshReport found = std::move(diagnosis.report);
  if (options.spacing > 0) found.largest_hole_in_samples = found.largest_hole / options.spacing;
  progress.stage("components", 1, 0.5, 0.7);
  add_components({mesh, diagnosis.orientation.use}, edges, options, progress, found);
  if (options.most_intersections > 0) {
    const SelfIntersections crossing = find_self_intersections(
        mesh, edges, {options.most_intersections, options.most_intersection_tests, 0.7, 1}, progress);
    found.intersecting_pairs = crossing.pairs;
    found.intersections_known = crossing.complete;
  }
  progress.stage("done", 1, 1, 1);
  return found;
}

}  // namespace

MeshReport report(MeshView mesh, const MeshReportOptions& options) try {
  check(options);
  if (mesh.triangles.empty()) {
    MeshReport empty;
    empty.sure = true;
    empty.why = "there are no triangles";
    return empty;
  }
  validate(mesh);
  ProgressMeter progress(options.progress);
  return Threads(options.execution.threads).run([&] { return examine(mesh, options, progress); });
} catch (...) {
  throw_as_error("report");
}

}  // namespace standoff
