// SPDX-License-Identifier: Apache-2.0
// The nearest triangle of a single point: down the hierarchy of boxes, the nearest one first. In double, so that the
// point may be anywhere.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "geometry/triangle_distance.h"
#include "points/nearest.h"

namespace standoff {
namespace {

using namespace cpu;

// A box that waits, and how far it is.
struct Waiting {
  double distance_sq;
  std::uint32_t entry;
};

// Lengths are in grid units of the index times shrink_, in which the square of a length does not overflow.
class Descent {
 public:
  Descent(const TriangleIndex& index, Vec3 point)
      : index_(index), world_(point), scale_(index.scale_at(point)), shrink_(scale_ / index.scale()) {
    const double(&center)[3] = index.clusters().center();
    local_ = point * scale_ - Vec3{center[0], center[1], center[2]} * shrink_;
  }

  NearestTriangle run() {
    std::array<Waiting, kMostWaiting> waiting;
    std::size_t count = 0;
    waiting[count++] = {0, index_.clusters().top()};
    while (count != 0) {
      const Waiting next = waiting[--count];
      if (next.distance_sq > best_sq_) continue;
      if (!index_.clusters().is_pack(next.entry)) {
        look_at(next.entry);
        continue;
      }
      const PackContents pack = index_.clusters().contents(next.entry);
      const std::size_t first = count;
      for (int n = 0; n < pack.count; ++n) {
        const double sq = box_distance_sq(*pack.boxes, n);
        if (sq <= best_sq_) waiting[count++] = {sq, pack.first + static_cast<std::uint32_t>(n)};
      }
      std::sort(waiting.begin() + static_cast<std::ptrdiff_t>(first),
                waiting.begin() + static_cast<std::ptrdiff_t>(count),
                [](const Waiting& a, const Waiting& b) { return a.distance_sq > b.distance_sq; });
    }
    return {std::sqrt(best_sq_) / scale_, triangle_};
  }

 private:
  // Sixteen children of each of eight levels.
  static constexpr std::size_t kMostWaiting = std::size_t{kLanes} * 9;

  // At most: boxes are grown by what the rounding of their corners takes, and the double arithmetic here is far below.
  double box_distance_sq(const BoxPack& boxes, int n) const {
    const auto outside = [&](int axis, double p) {
      return std::max({boxes.low[axis][n] * shrink_ - p, p - boxes.high[axis][n] * shrink_, 0.0});
    };
    const double x = outside(0, local_.x), y = outside(1, local_.y), z = outside(2, local_.z);
    return (x * x + y * y + z * z) * (1 - 1e-14);
  }

  void look_at(std::uint32_t entry) {
    const std::uint32_t triangle = index_.clusters().triangle(entry);
    const auto corner = [&](int n) { return triple_of((index_.mesh().corner(triangle, n) - world_) * scale_); };
    const double sq = origin_distance_sq(corner(0), corner(1), corner(2));
    if (sq > best_sq_ || (sq == best_sq_ && triangle > triangle_)) return;
    best_sq_ = sq;
    triangle_ = triangle;
  }

  const TriangleIndex& index_;
  Vec3 world_;
  double scale_, shrink_;
  Vec3 local_;  // relative to the middle
  double best_sq_ = std::numeric_limits<double>::infinity();
  std::uint32_t triangle_ = kNoTriangle;
};

}  // namespace

NearestTriangle find_nearest(const TriangleIndex& index, Vec3 point) { return Descent(index, point).run(); }

}  // namespace standoff
