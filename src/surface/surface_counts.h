// SPDX-License-Identifier: Apache-2.0
// What a thread counts of the surface it makes, and the limits of what can be numbered.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "standoff/error.h"
#include "standoff/surface.h"

namespace standoff {

struct SurfaceCounts {
  std::int64_t ambiguous = 0;  ///< ambiguous faces; both cells of a face count it
  std::int64_t clamped = 0, capped = 0;

  /// A crossed edge between samples of these values, in a field of this thickness.
  void count_edge(float lower, float upper, float thickness, bool leaves_grid) {
    if (leaves_grid)
      ++capped;
    else if (std::isfinite(thickness) && (std::abs(lower) >= thickness || std::abs(upper) >= thickness))
      ++clamped;
  }
  void add_to(IsoReport& report) const {
    report.clamped += clamped;
    report.capped += capped;
  }
};

/// Throws Error{limit} if so many vertices cannot be numbered.
inline void expect_countable(std::uint64_t vertices) {
  constexpr std::uint64_t kMost = 0xfffffffe;
  if (vertices > kMost)
    throw Error(ErrorCode::limit, "isosurface: " + std::to_string(vertices) +
                                      " vertices are more than 32-bit indices can number; take fewer samples");
}

}  // namespace standoff
