// SPDX-License-Identifier: Apache-2.0
// Fields in slabs: for fields that are larger than memory.
#pragma once

#include <cstdint>
#include <memory>

#include "standoff/compute.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff {

/// A field that comes slab by slab. A slab is some slices of the grid, all of their samples, as a field of its own.
/// write_field() of standoff/io.h writes one without ever holding all of it. SlabComputation makes one of a mesh; a
/// class of your own may make one of anything.
class STANDOFF_API FieldSlabs {
 public:
  FieldSlabs() = default;
  FieldSlabs(const FieldSlabs&) = delete;
  FieldSlabs& operator=(const FieldSlabs&) = delete;
  virtual ~FieldSlabs() = default;

  /// Of the whole field.
  virtual const Grid& grid() const = 0;
  /// Half-width of the band, world units. That of each slab.
  virtual double thickness() const = 0;
  /// Whether the slabs have nearest triangles.
  virtual bool has_nearest() const = 0;
  /// Where the field comes from. Known before the first slab.
  virtual const Provenance& provenance() const = 0;
  /// The next slab in ascending z, nullptr after the last one. It has as many samples along x and y as grid(); the
  /// slices of all slabs are those of grid(). It is valid until the next call, or until this object is destroyed.
  virtual const DistanceField* next() = 0;
};

/// The field that compute() computes, slab by slab, with the same values bit for bit:
///
///     SlabComputation slabs(mesh, grid, thickness, options);
///     write_field("large.vti", slabs);
///
/// Slabs are windows (standoff/windows.h) of whole slices. The mesh is prepared once, for all slabs. Memory: that of
/// one slab, of the backend's scratch and of the sign (docs/tiles.md, Fields larger than memory). Where something needs
/// the whole field at once, the only slab is the whole field, and memory is that of compute(): SignMethod::normal and
/// ::facet, and methods with MethodInfo::spreads.
class STANDOFF_API SlabComputation final : public FieldSlabs {
 public:
  /// Checks and prepares. Where the only slab is the whole field it is computed here, else no distance is computed yet.
  /// The mesh must stay where it is. `slab_samples`: how many samples a slab may have, 1 or more; slabs are a multiple
  /// of 16 slices, at least 16. Errors: as compute(); usage also for slab_samples below 1. The memory limit is that of
  /// the slabs; estimate() says what they take.
  SlabComputation(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options = {},
                  std::int64_t slab_samples = kSlabSamples);
  /// A mesh that nobody keeps would be gone before the first slab.
  SlabComputation(Mesh&& mesh, const Grid& grid, double thickness, const ComputeOptions& options = {},
                  std::int64_t slab_samples = kSlabSamples) = delete;
  ~SlabComputation() override;

  const Grid& grid() const override;
  double thickness() const override;
  bool has_nearest() const override;
  const Provenance& provenance() const override;
  /// The slab's grid is a window of grid(). Errors: limit, device, interrupted.
  /// After an error no slab follows: usage.
  const DistanceField* next() override;

  /// What was done for the slabs so far; complete after the last one.
  const ComputeReport& report() const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace standoff
