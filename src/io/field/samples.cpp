// SPDX-License-Identifier: Apache-2.0
#include "io/field/samples.h"

#include <algorithm>

namespace standoff {

std::uint64_t sample_bytes(const Grid& grid) {
  // Valid grids count up to 2^62 samples; no file is that long, whatever a header says.
  return 4 * static_cast<std::uint64_t>(std::min(grid.sample_count(), std::int64_t{1} << 61));
}

}  // namespace standoff
