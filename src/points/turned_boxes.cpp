// SPDX-License-Identifier: Apache-2.0
#include "points/turned_boxes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/triangle_frame.h"
#include "standoff/vec.h"

namespace standoff {
namespace {

using cpu::kLanes;
using cpu::PackTree;
using cpu::TurnedPack;

// What boxes are grown by on each side, as a share of the extent of the index: the rounding of a point within four
// extents, of the products of its coordinates with a float axis, and of the box itself. 64 roundings.
constexpr double kTurnedError = 64 * 0x1p-24;

// What a box is made around: points, and the directions that decide how it is turned.
class Hull {
 public:
  void add(const Vec3& p) {
    if (count_ == points_.size()) return;  // never: points are counted beforehand
    points_[count_++] = p;
  }
  /// A direction the hull is long in.
  void add_along(const Vec3& along) {
    if (dot(along, along) > dot(along_, along_)) along_ = along;
  }
  /// A normal times an area; its sign does not matter.
  void add_normal(const Vec3& normal) { normal_ = dot(normal, normal_) < 0 ? normal_ - normal : normal_ + normal; }

  void store(double grow, TurnedPack& to, int lane) const {
    const Triple<double> zero{0, 0, 0}, along = triple_of(along_), normal = triple_of(normal_);
    constexpr double kLeast = 1e-30;
    const Triple<double> u = unit_or(along, dot(along, along), kLeast, Triple<double>{1, 0, 0});
    const Triple<double> across = minus_scaled(normal, u, dot(normal, u));
    const Triple<double> w = unit_or(across, dot(across, across), kLeast, any_perpendicular(u));
    const Triple<double> axes[3] = {u, cross(w, u), w};
    Vec3 center;
    double half[3];
    for (int n = 0; n < 3; ++n) {
      double low = dot(axes[n], count_ == 0 ? zero : triple_of(points_[0])), high = low;
      for (std::size_t k = 1; k < count_; ++k) {
        const double at = dot(axes[n], triple_of(points_[k]));
        low = std::min(low, at), high = std::max(high, at);
      }
      center = center + vec_of(axes[n]) * ((low + high) / 2);
      half[n] = (high - low) / 2;
    }
    const double centers[3] = {center.x, center.y, center.z};
    for (int n = 0; n < 3; ++n) {
      const double axis[3] = {axes[n].x, axes[n].y, axes[n].z};
      to.center[n][lane] = static_cast<float>(centers[n]);
      for (int coordinate = 0; coordinate < 3; ++coordinate)
        to.axis[n][coordinate][lane] = static_cast<float>(axis[coordinate]);
      to.half[n][lane] = static_cast<float>(half[n] * (1 + 1e-6) + grow);
    }
  }

 private:
  std::array<Vec3, 8 * kLanes> points_;
  std::size_t count_ = 0;
  Vec3 along_, normal_;
};

// Of a pack of level 0: its triangles.
void add_triangles(const PackTree& tree, std::uint32_t pack, double scale, Vec3 center, Hull& hull) {
  const std::uint32_t first = pack * kLanes, end = std::min<std::uint32_t>(first + kLanes, tree.triangles);
  for (std::uint32_t place = first; place < end; ++place) {
    const std::uint32_t* const corners = tree.corners + 3 * std::size_t{tree.index[place]};
    std::array<Vec3, 3> t;
    for (std::size_t n = 0; n < 3; ++n) {
      const double* const v = tree.vertices + 3 * std::size_t{corners[n]};
      t[n] = Vec3{v[0], v[1], v[2]} * scale - center;
      hull.add(t[n]);
    }
    const Vec3 a = t[1] - t[0], b = t[2] - t[0];
    hull.add_along(a), hull.add_along(b), hull.add_along(b - a);
    hull.add_normal(cross(a, b));
  }
}

// Of another pack: the boxes of its parts.
void add_boxes(const TurnedPack& boxes, int count, Hull& hull) {
  for (int lane = 0; lane < count; ++lane) {
    const Vec3 center{boxes.center[0][lane], boxes.center[1][lane], boxes.center[2][lane]};
    Vec3 side[3];
    for (int n = 0; n < 3; ++n)
      side[n] =
          Vec3{boxes.axis[n][0][lane], boxes.axis[n][1][lane], boxes.axis[n][2][lane]} * double{boxes.half[n][lane]};
    for (int corner = 0; corner < 8; ++corner)
      hull.add(center + side[0] * (corner & 1 ? 1.0 : -1.0) + side[1] * (corner & 2 ? 1.0 : -1.0) +
               side[2] * (corner & 4 ? 1.0 : -1.0));
    for (const Vec3& along : side) hull.add_along(along);
    hull.add_normal(cross(side[0], side[1]));
  }
}

}  // namespace

std::unique_ptr<TurnedPack[]> make_turned_packs(const PackTree& tree, double scale, Vec3 center, float extent,
                                                ProgressMeter& progress) {
  const auto top = static_cast<std::uint32_t>(tree.top);
  auto all = std::make_unique_for_overwrite<TurnedPack[]>(tree.begin[top + 1] - tree.begin[1]);
  const double grow = kTurnedError * double{extent};
  for (std::uint32_t level = 1; level <= top; ++level) {
    const std::uint32_t below = tree.begin[level - 1], end = tree.begin[level];
    const tbb::blocked_range<std::uint32_t> packs(tree.begin[level], tree.begin[level + 1], 64);
    tbb::parallel_for(packs, [&](const auto& range) {
      progress.check();
      for (std::uint32_t pack = range.begin(); pack < range.end(); ++pack) {
        TurnedPack& to = all[pack - tree.begin[1]];
        const std::uint32_t first = below + kLanes * (pack - tree.begin[level]);
        for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
          Hull hull;
          const std::uint32_t part = first + lane;
          if (part < end && level == 1) add_triangles(tree, part, scale, center, hull);
          if (part < end && level > 1) {
            const std::uint32_t its_first = tree.begin[level - 2] + kLanes * (part - below);
            add_boxes(all[part - tree.begin[1]], static_cast<int>(std::min<std::uint32_t>(kLanes, below - its_first)),
                      hull);
          }
          hull.store(grow, to, static_cast<int>(lane));
        }
      }
    });
  }
  return all;
}

}  // namespace standoff
