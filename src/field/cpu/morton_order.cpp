// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include "field/cpu/radix_sort.h"
#include "field/cpu/triangle_centers.h"
#include "field/cpu/triangle_order.h"
#include "geometry/triangle_box.h"

namespace standoff::cpu {

std::vector<std::uint32_t> morton_order(const Job& job) {
  std::vector<KeyedIndex> keyed(static_cast<std::size_t>(job.triangle_count()));
  for_each_center(job, [&](std::size_t n, std::uint32_t triangle, const Vec3& at) {
    const auto cell = [](double v) { return static_cast<std::uint32_t>(v * 1023); };
    keyed[n] = {static_cast<std::uint32_t>(morton(cell(at.x), cell(at.y), cell(at.z))), triangle};
  });
  radix_sort(keyed, job.threads);
  std::vector<std::uint32_t> order(keyed.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, order.size(), 65536), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) order[n] = keyed[n].index;
  });
  return order;
}

}  // namespace standoff::cpu
