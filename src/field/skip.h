// Skip rules: which triangles may be left out before any distance is computed.
#pragma once

#include <cstdint>
#include <vector>

#include "difi/compute.h"

namespace difi {

/// The triangles that stay, ascending; every triangle when `rule` is none. The grown boxes of the rules are the
/// triangles' boxes grown by `thickness` on all sides.
std::vector<std::uint32_t> kept_triangles(MeshView mesh, const Grid& grid, double thickness, SkipRule rule, int threads);

}  // namespace difi
