// SPDX-License-Identifier: Apache-2.0
#include "io/field/field_source.h"

#include <string>

#include "core/guarded.h"
#include "standoff/error.h"

namespace standoff {

FieldSource::FieldSource(const DistanceField& field, std::span<const Sidecar> sidecars)
    : grid_(field.grid()),
      thickness_(field.thickness()),
      provenance_(field.provenance()),
      whole_(&field),
      arrays_(arrays_of(field, sidecars)) {}

FieldSource::FieldSource(FieldSlabs& slabs)
    : grid_(slabs.grid()),
      thickness_(slabs.thickness()),
      provenance_(slabs.provenance()),
      slabs_(&slabs),
      arrays_{distance_array(thickness_, nullptr)} {}

const DistanceField* FieldSource::next_slab(std::int64_t slices_before) const {
  const auto fail = [](const std::string& what) {
    throw Error(ErrorCode::usage, "a field in slabs: " + what + "; give slabs that make up its grid");
  };
  const DistanceField* const slab = call_back([&] { return slabs_->next(); });
  const std::int64_t slices = slices_before + (slab ? slab->grid().size.z : 0);
  if (slab && (slab->grid().size.x != grid_.size.x || slab->grid().size.y != grid_.size.y))
    fail("the slices of a slab are not as large as those of the grid");
  if (slab && static_cast<float>(slab->thickness()) != static_cast<float>(thickness_))
    fail("a slab has a thickness of its own");
  if (slices > grid_.size.z || (!slab && slices != grid_.size.z))
    fail("its slabs have " + std::to_string(slices) + (slab ? " slices or more" : " slices") + ", where the grid has " +
         std::to_string(grid_.size.z));
  return slab;
}

}  // namespace standoff
