// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "field/cpu/clusters.h"
#include "field/cpu/triangle_centers.h"
#include "field/cpu/triangle_order.h"

namespace standoff::cpu {
namespace {

struct Center {
  std::array<float, 3> at;
  std::uint32_t triangle;
};

std::size_t longest_axis(std::span<const Center> part) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::array<float, 3> low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
  for (const Center& c : part)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], c.at[axis]);
      high[axis] = std::max(high[axis], c.at[axis]);
    }
  const auto side = [&](std::size_t axis) { return high[axis] - low[axis]; };
  const std::size_t of_xy = side(1) > side(0) ? 1 : 0;
  return side(2) > side(of_xy) ? 2 : of_xy;
}

// Triangles below which a part is not worth a task of its own.
constexpr std::size_t kHalvingTask = 8192;

// `pack`: the most triangles of a pack of the highest level of which the part may hold several.
void halve(std::span<Center> part, std::size_t pack, const Job& job) {
  constexpr auto kFanout = static_cast<std::size_t>(Clusters::kFanout);
  while (pack >= part.size() && pack >= kFanout) pack /= kFanout;
  if (pack < kFanout) return;
  const std::size_t packs = (part.size() + pack - 1) / pack, middle = (packs + 1) / 2 * pack, axis = longest_axis(part);
  const auto less = [axis](const Center& a, const Center& b) { return a.at[axis] < b.at[axis]; };
  std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(middle), part.end(), less);
  const auto left = [&] { halve(part.first(middle), pack, job); };
  const auto right = [&] { halve(part.subspan(middle), pack, job); };
  if (part.size() >= kHalvingTask) {
    job.progress.check();
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
}

}  // namespace

std::vector<std::uint32_t> halving_order(const Job& job) {
  std::vector<Center> centers(static_cast<std::size_t>(job.triangle_count()));
  for_each_center(job, [&](std::size_t n, std::uint32_t triangle, const Vec3& at) {
    centers[n] = {{static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)}, triangle};
  });
  std::size_t pack = 1;
  while (pack < centers.size()) pack *= static_cast<std::size_t>(Clusters::kFanout);
  halve(centers, pack, job);
  std::vector<std::uint32_t> order(centers.size());
  std::ranges::transform(centers, order.begin(), &Center::triangle);
  return order;
}

}  // namespace standoff::cpu
