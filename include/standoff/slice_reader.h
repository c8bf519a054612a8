// SPDX-License-Identifier: Apache-2.0
// Fields that are read some slices at a time, so that they may be larger than memory.
#pragma once

#include <cstdint>
#include <functional>

#include "standoff/field.h"

namespace standoff {

/// Reads `count` slices of a field from slice `first` on: the field of that window of its grid. surface() and verify()
/// take one in place of a field.
using SliceReader = std::function<DistanceField(std::int64_t first, std::int64_t count)>;

}  // namespace standoff
