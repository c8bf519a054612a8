// SPDX-License-Identifier: Apache-2.0
#include "field/skip.h"

#include <numeric>

namespace standoff {

std::vector<std::uint32_t> kept_triangles(MeshView mesh, const Grid& grid, double thickness, SkipRule rule) {
  if (const SkipRow* row = find_skip_rule(rule.kind)) return row->kept(mesh, grid, thickness, rule.fraction);
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

std::int64_t skip_bytes(std::int64_t triangles, SkipRule rule) {
  const SkipRow* row = find_skip_rule(rule.kind);
  return triangles * (row ? row->bytes_per_triangle : std::int64_t{sizeof(std::uint32_t)});
}

}  // namespace standoff
