#include "cpu/clusters.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "cpu/radix_sort.h"

namespace difi::cpu {
namespace {

// Bits 0, 3, 6, ... of the result are the ten lowest bits of v.
constexpr std::uint32_t spread(std::uint32_t v) {
  v = (v | v << 16) & 0x030000ff;
  v = (v | v << 8) & 0x0300f00f;
  v = (v | v << 4) & 0x030c30c3;
  return (v | v << 2) & 0x09249249;
}

ClusterBox united(const ClusterBox& a, const ClusterBox& b) {
  ClusterBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(a.low[axis], b.low[axis]);
    box.high[axis] = std::max(a.high[axis], b.high[axis]);
  }
  return box;
}

}  // namespace

Clusters::Clusters(const Job& job, const Lattice& lattice) : job_(job), lattice_(lattice) {
  for (int axis = 0; axis < 3; ++axis)
    center[axis] = (lattice.origin[axis] + lattice.spacing[axis] * static_cast<double>(lattice.size[axis] - 1) / 2) *
                   lattice.scale;
  sort();
  build_nodes();
}

ClusterBox Clusters::triangle_box(std::uint32_t triangle) const {
  const Vec3 a = job_.mesh.corner(triangle, 0), b = job_.mesh.corner(triangle, 1), c = job_.mesh.corner(triangle, 2);
  const Vec3 low = min(a, min(b, c)), high = max(a, max(b, c));
  const double lows[3] = {low.x, low.y, low.z}, highs[3] = {high.x, high.y, high.z};
  ClusterBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = static_cast<float>(lows[axis] * lattice_.scale - center[axis]) - slack_;
    box.high[axis] = static_cast<float>(highs[axis] * lattice_.scale - center[axis]) + slack_;
  }
  return box;
}

void Clusters::sort() {
  const std::int64_t count = job_.triangle_count();
  const auto included = [&](const tbb::blocked_range<std::int64_t>& range, Box box) {
    for (std::int64_t n = range.begin(); n < range.end(); ++n)
      for (int k = 0; k < 3; ++k) box.include(job_.mesh.corner(job_.triangle(n), k));
    return box;
  };
  const auto both = [](Box a, const Box& b) {
    a.include(b.min);
    a.include(b.max);
    return a;
  };
  const Box box = tbb::parallel_reduce(tbb::blocked_range<std::int64_t>(0, count, 4096), Box{}, included, both);

  double farthest = 0;
  const double lows[3] = {box.min.x, box.min.y, box.min.z}, highs[3] = {box.max.x, box.max.y, box.max.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double half = lattice_.spacing[axis] * lattice_.scale * static_cast<double>(lattice_.size[axis]);
    farthest = std::max({farthest, half, std::abs(lows[axis] * lattice_.scale - center[axis]),
                         std::abs(highs[axis] * lattice_.scale - center[axis])});
  }
  slack_ = static_cast<float>(farthest * 0x1p-20);

  const double longest = std::max({box.extent().x, box.extent().y, box.extent().z});
  const double to_cells = longest > 0 ? 1023 / longest : 0;
  std::vector<KeyedIndex> keyed(static_cast<std::size_t>(count));
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, 4096), [&](const auto& range) {
    for (std::int64_t n = range.begin(); n < range.end(); ++n) {
      const std::uint32_t triangle = job_.triangle(n);
      Box own;
      for (int k = 0; k < 3; ++k) own.include(job_.mesh.corner(triangle, k));
      const Vec3 at = (own.center() - box.min) * to_cells;
      const auto cell = [](double v) { return static_cast<std::uint32_t>(v < 1023 ? v : 1023); };
      keyed[n] = {spread(cell(at.x)) | spread(cell(at.y)) << 1 | spread(cell(at.z)) << 2, triangle};
    }
  });
  radix_sort(keyed, job_.threads);
  order.resize(keyed.size());
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, 65536), [&](const auto& range) {
    for (std::int64_t n = range.begin(); n < range.end(); ++n) order[n] = keyed[n].index;
  });
}

void Clusters::build_nodes() {
  std::uint32_t begin = 0, end = triangles();
  roots_begin_ = begin;
  while (end - begin > kFanout) {
    const std::uint32_t nodes = (end - begin + kFanout - 1) / kFanout;
    const std::size_t base = boxes_.size();
    boxes_.resize(base + nodes);
    first_.resize(base + nodes);
    count_.resize(base + nodes);
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, nodes, 1024), [&](const auto& range) {
      for (std::uint32_t n = range.begin(); n < range.end(); ++n) {
        const std::uint32_t first = begin + n * kFanout, last = std::min(first + kFanout, end);
        ClusterBox united_box = box(first);
        for (std::uint32_t child = first + 1; child < last; ++child) united_box = united(united_box, box(child));
        boxes_[base + n] = united_box;
        first_[base + n] = first;
        count_[base + n] = static_cast<std::uint8_t>(last - first);
      }
    });
    begin = triangles() + static_cast<std::uint32_t>(base);
    end = begin + nodes;
    roots_begin_ = begin;
  }
}

}  // namespace difi::cpu
