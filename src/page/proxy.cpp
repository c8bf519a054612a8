// SPDX-License-Identifier: Apache-2.0
#include "page/proxy.h"

#ifdef STANDOFF_HAVE_MESHOPT
#include <meshoptimizer.h>

#include "standoff/mesh.h"

namespace standoff::page {

bool can_simplify() { return true; }

std::vector<Triangle> simplified(std::span<const Triangle> triangles, std::span<const float> vertices,
                                 std::size_t most) {
  std::vector<Triangle> out(triangles.size());
  const unsigned* const from = triangles.front().data();
  unsigned* const to = out.front().data();
  // Any error is fine: what matters is the count. The first keeps the topology, and stops where that holds it up.
  constexpr float kAnyError = 1e10f;
  std::size_t indices = meshopt_simplify(to, from, 3 * triangles.size(), vertices.data(), vertices.size() / 3,
                                         3 * sizeof(float), 3 * most, kAnyError, 0, nullptr);
  if (indices > 3 * most)
    indices = meshopt_simplifySloppy(to, from, 3 * triangles.size(), vertices.data(), vertices.size() / 3,
                                     3 * sizeof(float), 3 * most, kAnyError, nullptr);
  out.resize(indices / 3);
  out.shrink_to_fit();
  return out;
}

}  // namespace standoff::page

#else

namespace standoff::page {

bool can_simplify() { return false; }

std::vector<Triangle> simplified(std::span<const Triangle>, std::span<const float>, std::size_t) { return {}; }

}  // namespace standoff::page

#endif
