// SPDX-License-Identifier: Apache-2.0
#include "field/computation.h"

#include "core/tile_count.h"
#include "field/memory.h"
#include "field/prepare.h"
#include "sign/outer/outer.h"
#include "sign/sign_text.h"
#include "standoff/version.h"

namespace standoff {

Computation::Computation(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options,
                         bool is_dense, std::int64_t slab_samples)
    : mesh_(mesh),
      options_(options),
      plan_(make_plan(static_cast<std::int64_t>(mesh.triangles.size()), grid, thickness, options, is_dense,
                      slab_samples)),
      threads_(options.execution.threads),
      progress_(options.progress) {}

void Computation::check() {
  threads_.run([&] {
    Stopwatch watch;
    progress_.stage("prepare", 1, 0, 0.1);
    check_mesh(mesh_, plan_, options_);
    sign_plan_ = plan_sign(mesh_, options_.sign, progress_);
    if (options_.sign.outer) plan_outer(mesh_, options_.sign, sign_plan_, progress_);
    if (plan_.slab_layers != 0 && !is_decided_in_slabs(sign_plan_.report.method)) {
      plan_.slab_layers = 0;
      check_mesh(mesh_, plan_, options_);
    }
    report_.seconds.prepare = watch.lap();
  });
}

Job Computation::job() {
  Stopwatch watch;
  kept_ = kept_by_plan(mesh_, plan_, sign_plan_.exposed, progress_);
  report_.seconds.prepare += watch.lap();
  progress_.stage("bin", 1, 0.1, 0.2);
  return {.mesh = mesh_,
          .kept = kept_,
          .grid = plan_.grid,
          .thickness = plan_.thickness,
          .threads = plan_.threads,
          .simd = options_.execution.simd,
          .progress = progress_,
          .device = options_.execution.device};
}

std::unique_ptr<Sides> Computation::sides(const NearestTriangles& nearest) {
  const UnsignedField field{plan_.grid, plan_.field_thickness, nearest, crossing_bytes(plan_)};
  return make_sides(mesh_, sign_plan_, options_.sign, field, progress_);
}

void Computation::finish(std::int64_t triangles, const Counts& counts, std::uint64_t hash) {
  report_.triangles = plan_.triangles;
  report_.skipped = plan_.triangles - sign_plan_.report.internal - triangles;
  report_.samples_examined = counts.samples_examined;
  report_.samples_band = counts.samples_band;
  report_.method = plan_.row->method_name;
  report_.backend = plan_.row->backend_name;
  report_.sign = sign_plan_.report;
  report_.device = plan_.row->device(options_.execution.simd, options_.execution.device);
  report_.threads = plan_.threads;
  report_.samples = plan_.grid.sample_count();
  report_.tiles = tile_count(plan_.grid.size);
  report_.provenance = {report_.method, hash, version(), written(sign_text_of(options_.sign, report_.sign))};
}

}  // namespace standoff
