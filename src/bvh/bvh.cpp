// SPDX-License-Identifier: Apache-2.0
#include "bvh/bvh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <limits>

#include "geometry/triangle_distance.h"

namespace standoff {

FloatBox BvhFrame::local(const Box& world) const {
  const Vec3 min = local(world.min), max = local(world.max);
  return {{static_cast<float>(min.x), static_cast<float>(min.y), static_cast<float>(min.z)},
          {static_cast<float>(max.x), static_cast<float>(max.y), static_cast<float>(max.z)}};
}

double BvhFrame::scale_at(const Vec3& point) const {
  const double farthest = std::max(max_norm(local(point)), double{extent});
  constexpr int kMostExponent = 64;
  if (farthest < 0x1p64) return scale;
  // A point may be too far for the units of a tiny mesh.
  const int exponent = std::isfinite(farthest) ? std::ilogb(farthest) : std::ilogb(max_norm(point)) + std::ilogb(scale);
  return std::ldexp(scale, std::min(0, kMostExponent - exponent));
}

BvhFrame frame_around(MeshView mesh) {
  const Box box = bounds(mesh);
  if (box.empty()) return {{}, 1, 1};
  const Vec3 center = box.min * 0.5 + box.max * 0.5;  // the sum itself may overflow
  const Vec3 reach = box.max * 0.5 - box.min * 0.5;
  double extent = std::max({reach.x, reach.y, reach.z});
  if (extent == 0) extent = std::max(max_norm(center), std::numeric_limits<double>::min());
  constexpr int kMostExponent = 1000;  // so that its products with the coordinates are finite
  const double scale = std::ldexp(1.0, std::min(-std::ilogb(extent), kMostExponent));
  return {center * scale, scale, static_cast<float>(extent * scale)};
}

Bvh::Bvh(MeshView mesh, std::vector<std::uint32_t> order, const BvhFrame& frame, ProgressMeter& progress,
         float (*centroids)[3])
    : frame_(frame), order_(std::move(order)) {
  level_begin_.clear();
  std::uint32_t nodes = 0;
  for (std::uint32_t count = triangles(); nodes == 0 || count > 1;) {
    level_begin_.push_back(nodes);
    count = std::max(1u, (count + kFanout - 1) / kFanout);  // no triangles: a node without children
    nodes += count;
  }
  level_begin_.push_back(nodes);
  boxes_ = HugePageArray<Boxes16>(nodes);
  box_triangles(mesh, progress, centroids);
  box_nodes(progress);
}

std::int64_t Bvh::entries_of(std::int64_t triangles) {
  std::int64_t entries = triangles;
  for (std::int64_t count = triangles, is_first = 1; is_first || count > 1; is_first = 0) {
    count = std::max<std::int64_t>(1, (count + kFanout - 1) / kFanout);
    entries += count;
  }
  return entries;
}

std::int64_t Bvh::bytes_of(std::int64_t triangles) {
  return triangles * std::int64_t{sizeof(std::uint32_t)} +
         (entries_of(triangles) - triangles) * std::int64_t{sizeof(Boxes16)};
}

FloatBox Bvh::box() const {
  FloatBox all;
  for (int n = 0; n < kFanout; ++n) all.include(lane_of(boxes_[nodes() - 1], n));
  return all;
}

namespace {

float rounding_of(float side, float extent) { return kBoxError * std::max(extent, std::abs(side)); }

void grow(Boxes16& boxes, float extent) {
  for (int axis = 0; axis < 3; ++axis)
    for (int n = 0; n < Boxes16::kLanes; ++n) {
      boxes.low[axis][n] -= rounding_of(boxes.low[axis][n], extent);
      boxes.high[axis][n] += rounding_of(boxes.high[axis][n], extent);
    }
}

}  // namespace

// The box of a triangle, with what its rounding takes.
FloatBox Bvh::grown_box(const std::array<Vec3, 3>& corners) const {
  const auto& [a, b, c] = corners;
  FloatBox box = frame_.local(Box{min(a, min(b, c)), max(a, max(b, c))});
  if (frame_.extent < 0) return box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] -= rounding_of(box.low[axis], frame_.extent);
    box.high[axis] += rounding_of(box.high[axis], frame_.extent);
  }
  return box;
}

void Bvh::set_box(std::uint32_t node, int lane, const FloatBox& box) {
  for (int axis = 0; axis < 3; ++axis) {
    boxes_[node].low[axis][lane] = box.low[axis];
    boxes_[node].high[axis][lane] = box.high[axis];
  }
}

// Boxes are grown sixteen at a time, by loops that compilers vectorize: one by one it took as long as reading corners.
void Bvh::box_triangles(MeshView mesh, ProgressMeter& progress, float (*centroids)[3]) {
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, level_begin_[1], 512), [&](const auto& range) {
    progress.check();
    for (std::uint32_t node = range.begin(); node < range.end(); ++node) {
      const std::uint32_t first = kFanout * node, count = std::min<std::uint32_t>(kFanout, triangles() - first);
      Boxes16 boxes{};
      for (std::uint32_t n = 0; n < count; ++n) {
        const auto [a, b, c] = mesh.corners(order_[first + n]);
        const Vec3 low = frame_.local(min(a, min(b, c))), high = frame_.local(max(a, max(b, c)));
        for (int axis = 0; axis < 3; ++axis) {
          boxes.low[axis][n] = static_cast<float>(low[axis]);
          boxes.high[axis][n] = static_cast<float>(high[axis]);
        }
        if (!centroids) continue;
        const Vec3 middle = frame_.local((a + b + c) * (1.0 / 3));
        for (int axis = 0; axis < 3; ++axis) centroids[first + n][axis] = static_cast<float>(middle[axis]);
      }
      if (frame_.extent >= 0) grow(boxes, frame_.extent);
      for (std::uint32_t n = count; n < kFanout; ++n) boxes.clear(static_cast<int>(n));
      boxes_[node] = boxes;
    }
  });
}

// The boxes of the children of a node above the triangles.
void Bvh::box_node(std::uint32_t number) {
  const BvhNode own = node(triangles() + number);
  for (int n = 0; n < kFanout; ++n) {
    if (n >= own.count) {
      boxes_[number].clear(n);
      continue;
    }
    const Boxes16& inner = boxes_[own.first - triangles() + static_cast<std::uint32_t>(n)];
    for (int axis = 0; axis < 3; ++axis) {
      boxes_[number].low[axis][n] = *std::min_element(inner.low[axis], inner.low[axis] + kFanout);
      boxes_[number].high[axis][n] = *std::max_element(inner.high[axis], inner.high[axis] + kFanout);
    }
  }
}

void Bvh::box_nodes(ProgressMeter& progress) {
  for (std::size_t level = 1; level + 1 < level_begin_.size(); ++level) {
    const tbb::blocked_range<std::uint32_t> all(level_begin_[level], level_begin_[level + 1], 512);
    tbb::parallel_for(all, [&](const auto& range) {
      progress.check();
      for (std::uint32_t number = range.begin(); number < range.end(); ++number) box_node(number);
    });
  }
}

bool Bvh::follow(MeshView mesh, std::span<const std::uint32_t> places) {
  const float most = 2 * frame_.extent;
  std::vector<std::uint32_t> above;  // nodes of a level, counted in it
  for (const std::uint32_t place : places) {
    const FloatBox box = grown_box(mesh.corners(order_[place]));
    for (int axis = 0; axis < 3; ++axis)
      if (!(box.low[axis] >= -most && box.high[axis] <= most)) return false;
    set_box(place / kFanout, static_cast<int>(place % kFanout), box);
    above.push_back(place / kFanout);
  }
  std::ranges::sort(above);
  for (std::size_t level = 1; level + 1 < level_begin_.size(); ++level) {
    for (std::uint32_t& number : above) number /= kFanout;
    above.erase(std::unique(above.begin(), above.end()), above.end());
    for (const std::uint32_t number : above) box_node(level_begin_[level] + number);
  }
  return true;
}

namespace {

// An entry that waits, and how far its box is at least.
struct Waiting {
  double distance_sq;
  std::uint32_t entry;
};

// The squared distance from a point to a box, in the frame's units times `shrink`, at most. Boxes are grown by what the
// rounding of their corners takes, and the arithmetic here is far below.
double box_distance_sq(const Boxes16& boxes, int n, const Vec3& local, double shrink) {
  const auto outside = [&](int axis, double p) {
    return std::max({boxes.low[axis][n] * shrink - p, p - boxes.high[axis][n] * shrink, 0.0});
  };
  const double x = outside(0, local.x), y = outside(1, local.y), z = outside(2, local.z);
  return (x * x + y * y + z * z) * (1 - 1e-14);
}

}  // namespace

// Goes down the hierarchy, into the nearest boxes first.
NearestTriangle nearest_triangle(const Bvh& bvh, MeshView mesh, const Vec3& point) {
  if (bvh.triangles() == 0) return {};
  double best_sq = std::numeric_limits<double>::infinity();
  std::uint32_t best = kNoTriangle;
  const double scale = bvh.frame().scale_at(point), shrink = scale / bvh.frame().scale;
  const Vec3 local = point * scale - bvh.frame().center * shrink;
  const auto measure = [&](std::uint32_t triangle) {
    // Relative to the point, so that a place far from the origin loses nothing.
    const auto corner = [&](int n) { return triple_of((mesh.corner(triangle, n) - point) * scale); };
    const double sq = origin_distance_sq(corner(0), corner(1), corner(2));
    if (sq > best_sq || (sq == best_sq && triangle > best)) return;
    best_sq = sq;
    best = triangle;
  };
  std::array<Waiting, kMostWaiting> waiting;
  std::size_t count = 0;
  waiting[count++] = {0, bvh.root()};
  while (count != 0) {
    const Waiting next = waiting[--count];
    if (next.distance_sq > best_sq) continue;
    if (!bvh.is_node(next.entry)) {
      measure(bvh.order()[next.entry]);
      continue;
    }
    const BvhNode node = bvh.node(next.entry);
    const std::size_t first = count;
    for (int n = 0; n < node.count; ++n) {
      const double sq = box_distance_sq(*node.boxes, n, local, shrink);
      if (sq <= best_sq) waiting[count++] = {sq, node.first + static_cast<std::uint32_t>(n)};
    }
    std::sort(waiting.begin() + static_cast<std::ptrdiff_t>(first),
              waiting.begin() + static_cast<std::ptrdiff_t>(count),
              [](const Waiting& a, const Waiting& b) { return a.distance_sq > b.distance_sq; });
  }
  return {std::sqrt(best_sq) / scale, best};
}

}  // namespace standoff
