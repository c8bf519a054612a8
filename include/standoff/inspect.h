// SPDX-License-Identifier: Apache-2.0
// Statistics of a field, for reports and for checking a file before use. Those of a mesh: mesh_report.h.
#pragma once

#include <cstdint>

#include "standoff/export.h"
#include "standoff/field.h"

namespace standoff {

struct FieldSummary {
  double min = 0, max = 0;  ///< of all values but NaN, world units; infinite if every value is NaN
  std::int64_t band = 0;    ///< samples in the band; see inspect
  std::int64_t nan = 0;     ///< samples that are not a number
};

/// Computes statistics over every sample of a field, in the time to go over its stored tiles: others have one value
/// each. If the field has nearest triangles, its band is the samples that have one, as in compute(). Otherwise it is
/// the samples nearer than the thickness, because a value that equals the thickness may be clamped.
STANDOFF_API FieldSummary inspect(const DistanceField& field);

}  // namespace standoff
