// SPDX-License-Identifier: Apache-2.0
// What a field file is written of: a field with its sidecars, or a field that comes slab by slab.
#pragma once

#include <span>
#include <vector>

#include "io/field/sample_arrays.h"
#include "standoff/field.h"
#include "standoff/slabs.h"

namespace standoff {

/// A view.
class FieldSource {
 public:
  explicit FieldSource(const DistanceField& field, std::span<const Sidecar> sidecars = {});
  /// Slabs come once, so they have one array: the distances.
  explicit FieldSource(FieldSlabs& slabs);

  const Grid& grid() const { return grid_; }
  double thickness() const { return thickness_; }
  const Provenance& provenance() const { return provenance_; }
  /// All of it; only a source that was made of a field has that.
  const DistanceField& whole() const { return *whole_; }
  /// Distances, nearest triangles where there are any, sidecars.
  const std::vector<SampleArray>& arrays() const { return arrays_; }

  /// Calls use(field, its array, number of its first sample) for the parts of an array in order. Throws Error{usage}
  /// where slabs do not make up the grid.
  template <class Use>
  void for_each_part(const SampleArray& array, const Use& use) const {
    if (whole_) return use(*whole_, array, std::int64_t{0});
    std::int64_t slices = 0;
    while (const DistanceField* slab = next_slab(slices)) {
      SampleArray part = array;
      part.values = distance_array(*slab).values;
      use(*slab, part, slices * grid_.size.x * grid_.size.y);
      slices += slab->grid().size.z;
    }
  }

 private:
  const DistanceField* next_slab(std::int64_t slices_before) const;

  const Grid& grid_;
  double thickness_;
  const Provenance& provenance_;
  const DistanceField* whole_ = nullptr;
  FieldSlabs* slabs_ = nullptr;
  std::vector<SampleArray> arrays_;
};

}  // namespace standoff
