// SPDX-License-Identifier: Apache-2.0
#include "points/ray_winding.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "sign/rows/ray_crossing.h"

namespace standoff {

template <class Use>
void RayWinding::for_each_between(const float (&to)[3], float from, const cpu::PointKernels& kernels,
                                  const Use& use) const {
  const cpu::Clusters& clusters = index_.clusters();
  constexpr std::size_t kMostWaiting = std::size_t{cpu::kLanes} * 9;  // children of each of eight levels
  std::array<std::uint32_t, kMostWaiting> waiting;
  std::size_t count = 0;
  waiting[count++] = clusters.top();
  while (count != 0) {
    const std::uint32_t entry = waiting[--count];
    if (clusters.is_pack(entry)) {
      const cpu::PackContents pack = clusters.contents(entry);
      for (std::uint32_t met = kernels.boxes_before(pack, to, from); met != 0; met &= met - 1)
        waiting[count++] = pack.first + static_cast<std::uint32_t>(std::countr_zero(met));
      continue;
    }
    const std::uint32_t triangle = clusters.triangle(entry);
    if (const int times = mesh_.use_of(triangle)) use(RayTriangle(mesh_.mesh.corners(triangle)), times);
  }
}

std::int32_t RayWinding::at(Vec3 point, const cpu::PointKernels& kernels) const {
  const Vec3 local = index_.local(point);
  if (!index_.is_near(local)) return 0;  // outside of the mesh's box
  const float to[3] = {static_cast<float>(local.x), static_cast<float>(local.y), static_cast<float>(local.z)};
  std::int32_t winding = 0;
  for_each_between(to, -std::numeric_limits<float>::infinity(), kernels, [&](const RayTriangle& triangle, int times) {
    const int crossing = triangle.crossing(point.y, point.z);
    if (crossing != 0 && triangle.is_past(point, crossing)) winding -= times * crossing;
  });
  return winding;
}

std::int32_t RayWinding::beyond(double x, Vec3 point, const cpu::PointKernels& kernels) const {
  const Vec3 other{x, point.y, point.z}, local = index_.local(point);
  const auto own_x = static_cast<float>(local.x), other_x = static_cast<float>(index_.local(other).x);
  const float to[3] = {std::max(own_x, other_x), static_cast<float>(local.y), static_cast<float>(local.z)};
  std::int32_t winding = 0;
  for_each_between(to, std::min(own_x, other_x), kernels, [&](const RayTriangle& triangle, int times) {
    const int crossing = triangle.crossing(point.y, point.z);
    if (crossing == 0) return;
    winding -= times * crossing * (int{triangle.is_past(point, crossing)} - int{triangle.is_past(other, crossing)});
  });
  return winding;
}

}  // namespace standoff
