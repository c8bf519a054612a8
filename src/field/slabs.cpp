// SPDX-License-Identifier: Apache-2.0
#include "standoff/slabs.h"

#include <algorithm>
#include <optional>
#include <string>

#include "core/guarded.h"
#include "core/tile_count.h"
#include "field/computation.h"
#include "field/lattice.h"
#include "field/plan.h"
#include "sign/sign_field.h"

namespace standoff {
namespace {

constexpr std::int64_t kTileLayers = kBrickSide / kTileSide;  // layers of tiles per layer of bricks

}  // namespace

class SlabComputation::Work {
 public:
  Work(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options, std::int64_t slab_samples)
      : options_(with_slabs(static_cast<std::int64_t>(mesh.triangles.size()), &mesh, grid, thickness, options,
                            slab_samples)),
        computation_(mesh, grid, thickness, options_, false, slab_samples) {
    computation_.check();
    if (plan().slab_layers == 0)
      fill_whole();
    else
      computation_.threads().run([&] { prepare(); });
  }

  const Plan& plan() const { return computation_.plan(); }
  const ComputeReport& report() const { return report_; }
  bool has_nearest() const { return options_.nearest; }

  const DistanceField* next() {
    if (failed_) throw Error(ErrorCode::usage, "compute: after an error there are no more slabs; begin again");
    const std::int64_t slices = plan().grid.size.z - first_slice_;
    if (slices == 0) {
      field_ = {};
      return nullptr;
    }
    failed_ = true;
    if (gather_) computation_.threads().run([&] { fill_slab(std::min(slices, kBrickSide * plan().slab_layers)); });
    first_slice_ += field_.grid().size.z;
    failed_ = false;
    if (gather_ && first_slice_ == plan().grid.size.z) computation_.progress().stage("done", 1, 1, 1);
    return &field_;
  }

 private:
  // The only slab.
  void fill_whole() { report_ = fill_field(computation_, field_, options_); }

  // Prepares the data that all slabs share.
  void prepare() {
    job_.emplace(computation_.job());
    Stopwatch watch;
    if (options_.hash_mesh) hash_ = content_hash(computation_.mesh());
    computation_.report().seconds.compute = watch.lap();
    if (const SignMethod method = computation_.sign_method();
        method != SignMethod::none && method != SignMethod::shell) {
      signs_ = computation_.signs({});
      if (signs_) rows_.emplace(*signs_, options_.sign.invert, plan().grid, computation_.progress());
    }
    computation_.report().seconds.sign = watch.lap();
    gather_ = plan().row->in_layers(*job_);
    computation_.report().seconds.compute += watch.lap();
    tell();
  }

  void fill_slab(std::int64_t slices) {
    Stopwatch watch;
    Grid part = plan().grid;
    part.origin = part.position(0, 0, first_slice_);
    part.size.z = slices;
    field_.reset(part, plan().field_thickness, plan().with_nearest);
    const std::int64_t layer = first_slice_ / kBrickSide;
    Sink sink(field_, kTileLayers * layer);
    gather_->gather({layer, layer + (slices + kBrickSide - 1) / kBrickSide}, sink);
    ComputeReport& report = computation_.report();
    report.seconds.compute += watch.lap();
    if (computation_.sign_method() == SignMethod::shell)
      apply(Shell(options_.sign, plan().field_thickness), field_, computation_.progress());
    if (rows_) sign_slab(*rows_, kTileLayers * layer, field_);
    report.seconds.sign += watch.lap();
    report.tiles_stored += field_.stored_tiles();
    tell();
    field_.set_provenance(report_.provenance);
  }

  void tell() {
    computation_.finish(job_->triangle_count(), gather_->counts(), hash_);
    report_ = computation_.report();
  }

  const ComputeOptions options_;
  Computation computation_;
  std::uint64_t hash_ = 0;
  std::optional<Job> job_;
  std::unique_ptr<LayerGather> gather_;  // null if the only slab is the whole field
  std::unique_ptr<SampleSigns> signs_;
  std::optional<RowsOfTiles> rows_;
  ComputeReport report_;
  DistanceField field_;
  std::int64_t first_slice_ = 0;  // of the next slab
  bool failed_ = false;
};

SlabComputation::SlabComputation(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options,
                                 std::int64_t slab_samples) try {
  validate(thickness, options);
  validate(grid);
  check_slab_samples(slab_samples);
  work_ = std::make_unique<Work>(mesh, grid, thickness, options, slab_samples);
} catch (...) {
  throw_as_error("compute", kWithLessMemory);
}

SlabComputation::~SlabComputation() = default;

const Grid& SlabComputation::grid() const { return work_->plan().grid; }
double SlabComputation::thickness() const { return work_->plan().field_thickness; }
bool SlabComputation::has_nearest() const { return work_->has_nearest(); }
const Provenance& SlabComputation::provenance() const { return work_->report().provenance; }
const ComputeReport& SlabComputation::report() const { return work_->report(); }

const DistanceField* SlabComputation::next() try { return work_->next(); } catch (...) {
  throw_as_error("compute", kWithLessMemory);
}

}  // namespace standoff
