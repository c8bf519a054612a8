// SPDX-License-Identifier: Apache-2.0
// What a thread counts of the surface it makes, and the limits of what can be numbered.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "core/memory.h"
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

/// Makes room for so many vertices and triangles in all. Throws Error{limit}.
inline void grow(Mesh& mesh, std::uint64_t vertices, std::uint64_t triangles, MemoryBudget& budget) {
  const auto grow_to = [&](auto& all, std::uint64_t count) {
    if (count <= all.capacity()) return all.resize(count);
    const std::size_t before = all.capacity() * sizeof all[0];
    budget.take(count * sizeof all[0]);
    all.reserve(count);
    budget.give_back(before);
    all.resize(count);
  };
  grow_to(mesh.vertices, vertices);
  grow_to(mesh.triangles, triangles);
}

}  // namespace standoff
