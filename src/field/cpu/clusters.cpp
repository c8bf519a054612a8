// SPDX-License-Identifier: Apache-2.0
// Orders of triangles: along a Morton curve, or by halving; then boxes, pack by pack.
#include "field/cpu/clusters.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "field/backend.h"
#include "geometry/triangle_box.h"

namespace standoff::cpu {

// The middles of triangles' boxes, which orders of triangles go by.

namespace {

/// Calls use(n, triangle, center) for the n-th triangle of a job, the center in the cube [0, 1]^3 around all of them.
/// On the threads of the calling TBB arena.
template <class Use>
void for_each_center(const Job& job, const Use& use) {
  using Blocked = tbb::blocked_range<std::int64_t>;
  const Blocked all(0, job.triangle_count(), 4096);
  const auto included = [&](const Blocked& range, Box box) {
    for (std::int64_t n = range.begin(); n < range.end(); ++n) {
      const Box own = triangle_box(job.mesh, job.triangle(n));
      box = {min(box.min, own.min), max(box.max, own.max)};
    }
    return box;
  };
  const auto both = [](const Box& a, const Box& b) { return Box{min(a.min, b.min), max(a.max, b.max)}; };
  const Box box = tbb::parallel_reduce(all, Box{}, included, both);
  const double longest = box.longest_side();
  const double scale = longest > 0 ? 1 / longest : 0;
  tbb::parallel_for(all, [&](const Blocked& range) {
    job.progress.check();
    for (std::int64_t n = range.begin(); n < range.end(); ++n) {
      const std::uint32_t triangle = job.triangle(n);
      const Vec3 at = (triangle_box(job.mesh, triangle).center() - box.min) * scale;
      use(static_cast<std::size_t>(n), triangle, min(at, Vec3{1, 1, 1}));
    }
  });
}

}  // namespace

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

Clusters::Clusters(const Job& job, const BlockLattice& lattice, std::vector<std::uint32_t> order)
    : job_(job), lattice_(lattice), order_(std::move(order)) {
  const auto middle = [&](int axis) { return static_cast<double>(lattice.size[axis] - 1) / 2; };
  const Triple<double> center = position(lattice, middle(0), middle(1), middle(2));
  center_[0] = center.x, center_[1] = center.y, center_[2] = center.z;
  for (int axis = 0; axis < 3; ++axis)
    extent_ = std::max(extent_, static_cast<float>(lattice.spacing[axis] * lattice.scale *
                                                   static_cast<double>(lattice.size[axis]) / 2));
  triangles_ = static_cast<std::uint32_t>(job.triangle_count());
  std::uint32_t packs = 0;
  for (std::uint32_t count = triangles_; packs == 0 || count > 1;) {
    level_begin_.push_back(packs);
    count = (count + kFanout - 1) / kFanout;
    packs += count;
  }
  level_begin_.push_back(packs);
  packs_ = std::make_unique_for_overwrite<BoxPack[]>(packs);
  points_ = std::make_unique_for_overwrite<float[][3]>(triangles_);
  box_triangles();
  box_packs();
}

std::int64_t Clusters::entries_of(std::int64_t triangles) {
  std::int64_t entries = triangles;
  for (std::int64_t count = triangles, is_first = 1; is_first || count > 1; is_first = 0) {
    count = (count + kFanout - 1) / kFanout;
    entries += count;
  }
  return entries;
}

std::int64_t Clusters::bytes(std::int64_t triangles, int threads) {
  constexpr auto point = static_cast<std::int64_t>(sizeof(float[3])), order = std::int64_t{sizeof(std::uint32_t)};
  const std::int64_t packs = entries_of(triangles) - triangles;
  return triangles * (point + order) + packs * std::int64_t{sizeof(BoxPack)} + radix_sort_bytes(triangles, threads);
}

PackContents Clusters::contents(std::uint32_t entry) const {
  const std::uint32_t pack = entry - triangles_;
  const std::size_t level = level_of(pack);
  // Of a level of n packs or triangles the k-th pack holds kFanout, from k * kFanout on.
  const std::uint32_t begin = level == 0 ? 0 : triangles_ + level_begin_[level - 1];
  const std::uint32_t end = level == 0 ? triangles_ : triangles_ + level_begin_[level];
  const std::uint32_t first = begin + kFanout * (pack - level_begin_[level]);
  return {first, static_cast<int>(std::min<std::uint32_t>(kFanout, end - first)), &packs_[pack]};
}

float Clusters::slack_at(float coordinate) const { return kBoxError * std::max(extent_, std::abs(coordinate)); }

void Clusters::box_triangles() {
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, level_begin_[1], 512), [&](const auto& range) {
    job_.progress.check();
    for (std::uint32_t pack = range.begin(); pack < range.end(); ++pack) {
      const std::uint32_t first = kFanout * pack, count = std::min<std::uint32_t>(kFanout, triangles_ - first);
      for (std::uint32_t n = 0; n < count; ++n) {
        const std::uint32_t triangle = order_[first + n];
        const auto [a, b, c] = job_.mesh.corners(triangle);
        const Box box{min(a, min(b, c)), max(a, max(b, c))};
        const Vec3 middle = (a + b + c) * (1.0 / 3);
        const double lows[3] = {box.min.x, box.min.y, box.min.z}, highs[3] = {box.max.x, box.max.y, box.max.z},
                     middles[3] = {middle.x, middle.y, middle.z};
        for (int axis = 0; axis < 3; ++axis) {
          points_[first + n][axis] = static_cast<float>(middles[axis] * lattice_.scale - center_[axis]);
          const auto low_at = static_cast<float>(lows[axis] * lattice_.scale - center_[axis]);
          const auto high_at = static_cast<float>(highs[axis] * lattice_.scale - center_[axis]);
          packs_[pack].low[axis][n] = low_at - slack_at(low_at);
          packs_[pack].high[axis][n] = high_at + slack_at(high_at);
        }
      }
    }
  });
}

void Clusters::box_packs() {
  for (std::size_t level = 1; level + 1 < level_begin_.size(); ++level) {
    const tbb::blocked_range<std::uint32_t> all(level_begin_[level], level_begin_[level + 1], 512);
    tbb::parallel_for(all, [&](const auto& range) {
      job_.progress.check();
      for (std::uint32_t pack = range.begin(); pack < range.end(); ++pack) {
        const PackContents packed = contents(triangles_ + pack);
        for (int n = 0; n < packed.count; ++n) {
          const PackContents inner = contents(packed.first + static_cast<std::uint32_t>(n));
          for (int axis = 0; axis < 3; ++axis) {
            const float *low = inner.boxes->low[axis], *high = inner.boxes->high[axis];
            packs_[pack].low[axis][n] = *std::min_element(low, low + inner.count);
            packs_[pack].high[axis][n] = *std::max_element(high, high + inner.count);
          }
        }
      }
    });
  }
}

}  // namespace standoff::cpu
