// SPDX-License-Identifier: Apache-2.0
#include "standoff/slabs.h"

#include <algorithm>

#include "core/guarded.h"
#include "field/windows.h"

namespace standoff {

class SlabComputation::Work {
 public:
  Work(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options, std::int64_t slab_samples)
      : windows_(mesh, grid, thickness, slab_size(grid, slab_samples), options) {}

  const FieldInWindows& windows() const { return windows_; }
  const Grid& grid() const { return windows_.plan().grid; }

  const DistanceField* next() {
    if (failed_) throw Error(ErrorCode::usage, "compute: after an error there are no more slabs; begin again");
    const std::int64_t slices = std::min(grid().size.z - first_slice_, windows_.plan().part.z);
    if (slices == 0) {
      field_ = {};
      return nullptr;
    }
    failed_ = true;
    if (windows_.plan().in_windows)
      windows_.compute({0, 0, first_slice_}, {grid().size.x, grid().size.y, slices}, field_);
    else
      field_ = windows_.take_whole();
    first_slice_ += slices;
    failed_ = false;
    if (windows_.plan().in_windows && first_slice_ == grid().size.z) windows_.progress().stage("done", 1, 1, 1);
    return &field_;
  }

 private:
  FieldInWindows windows_;
  DistanceField field_;
  std::int64_t first_slice_ = 0;  // of the next slab
  bool failed_ = false;
};

SlabComputation::SlabComputation(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options,
                                 std::int64_t slab_samples) try {
  validate(thickness, options);
  validate(grid);
  work_ = std::make_unique<Work>(mesh, grid, thickness, options, slab_samples);
} catch (...) {
  throw_as_error("compute", kWithLessMemory);
}

SlabComputation::~SlabComputation() = default;

const Grid& SlabComputation::grid() const { return work_->grid(); }
double SlabComputation::thickness() const { return work_->windows().plan().field_thickness; }
bool SlabComputation::has_nearest() const { return work_->windows().has_nearest(); }
const Provenance& SlabComputation::provenance() const { return report().provenance; }
const ComputeReport& SlabComputation::report() const { return work_->windows().report(); }

const DistanceField* SlabComputation::next() try { return work_->next(); } catch (...) {
  throw_as_error("compute", kWithLessMemory);
}

}  // namespace standoff
