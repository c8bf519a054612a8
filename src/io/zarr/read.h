// SPDX-License-Identifier: Apache-2.0
// Fields out of stores.
#pragma once

#include <cstdint>

#include "io/zarr/metadata.h"
#include "standoff/field.h"

namespace standoff {
class ProgressMeter;
}

namespace standoff::zarr {

/// The field of `size` samples from `first` on: see ZarrStore::read. `memory_limit`: bytes, 0 for none.
DistanceField read_window(const StoreMetadata& store, const Size3& first, const Size3& size, std::int64_t memory_limit,
                          ProgressMeter& meter);

}  // namespace standoff::zarr
