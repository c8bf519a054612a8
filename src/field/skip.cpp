// SPDX-License-Identifier: Apache-2.0
#include "field/skip.h"

#include <numeric>

namespace standoff {

std::vector<std::uint32_t> kept_triangles(MeshView mesh, const Grid& grid, double thickness, SkipRule rule) {
  switch (rule.kind) {
    case SkipRule::Kind::neighbour:
      return kept_by_neighbour_rule(mesh, thickness, rule.fraction);
    case SkipRule::Kind::exact:
      return kept_by_exact_rule(mesh, grid, thickness);
    case SkipRule::Kind::automatic:
    case SkipRule::Kind::none:
      break;
  }
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

std::int64_t skip_bytes(std::int64_t triangles, SkipRule rule) {
  // The result, and for the exact rule a hash, an entry to sort, a flag, and 8 KiB of counters per 2^14 triangles.
  return triangles * (rule.kind == SkipRule::Kind::exact ? 18 : 4);
}

}  // namespace standoff
