// SPDX-License-Identifier: Apache-2.0
#include "points/ray_winding.h"

#include <array>
#include <bit>

#include "sign/rows/ray_crossing.h"

namespace standoff {

std::int32_t RayWinding::at(Vec3 point, const cpu::PointKernels& kernels) const {
  const Vec3 local = index_.local(point);
  if (!index_.is_near(local)) return 0;  // outside of the mesh's box
  const float at[3] = {static_cast<float>(local.x), static_cast<float>(local.y), static_cast<float>(local.z)};
  const cpu::Clusters& clusters = index_.clusters();
  std::int32_t winding = 0;
  constexpr std::size_t kMostWaiting = std::size_t{cpu::kLanes} * 9;  // children of each of eight levels
  std::array<std::uint32_t, kMostWaiting> waiting;
  std::size_t count = 0;
  waiting[count++] = clusters.top();
  while (count != 0) {
    const std::uint32_t entry = waiting[--count];
    if (clusters.is_pack(entry)) {
      const cpu::PackContents pack = clusters.contents(entry);
      for (std::uint32_t met = kernels.boxes_before(pack, at); met != 0; met &= met - 1)
        waiting[count++] = pack.first + static_cast<std::uint32_t>(std::countr_zero(met));
      continue;
    }
    const std::uint32_t triangle = clusters.triangle(entry);
    const int use = mesh_.use_of(triangle);
    if (use == 0) continue;
    const RayTriangle ray(mesh_.mesh.corners(triangle));
    const int crossing = ray.crossing(point.y, point.z);
    if (crossing != 0 && ray.is_past(point, crossing)) winding -= use * crossing;
  }
  return winding;
}

}  // namespace standoff
