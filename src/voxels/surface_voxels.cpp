// SPDX-License-Identifier: Apache-2.0
// Finds the voxels that a mesh's surface passes through.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "core/grid_axis.h"
#include "core/guarded.h"
#include "core/number_text.h"
#include "core/progress.h"
#include "core/threads.h"
#include "sign/rows/sample_axis.h"
#include "standoff/error.h"
#include "standoff/vec.h"
#include "standoff/voxels.h"

namespace standoff {

// Whether a triangle and an axis-aligned box have a point in common: by separating axes (Akenine-Moeller, Fast 3D
// triangle-box overlap testing, 2001).
//
// The axes themselves may be rounded, because any axis that separates proves that triangle and box are apart. The error
// of a projection is less than 8 u times the sum of |axis| times the magnitudes multiplied with it. An axis separates
// only by more than kSlack times that sum: so no overlap is missed.

namespace {

class TriangleInVoxels {
 public:
  /// `half`: half the sides of a voxel.
  TriangleInVoxels(const std::array<Vec3, 3>& corners, const Vec3& half)
      : t_(corners),
        half_(half),
        edges_{t_[1] - t_[0], t_[2] - t_[1], t_[0] - t_[2]},
        normal_(cross(edges_[0], edges_[1])) {}

  const Vec3& normal() const { return normal_; }
  /// Whether most digits of the normal survive rounding.
  bool normal_is_good() const { return length(normal_) > 1e-4 * max_norm(edges_[0]) * max_norm(edges_[1]); }

  /// True for all voxels that overlap, and for some that are apart by no more than rounding.
  bool overlaps(const Vec3& center) const {
    const Vec3 v[3] = {t_[0] - center, t_[1] - center, t_[2] - center};
    const auto most = [&](double a, double b, double c) { return std::max({std::abs(a), std::abs(b), std::abs(c)}); };
    const Vec3 reach{most(v[0].x, v[1].x, v[2].x) + half_.x, most(v[0].y, v[1].y, v[2].y) + half_.y,
                     most(v[0].z, v[1].z, v[2].z) + half_.z};
    const auto apart = [&](const Vec3& axis) {
      const Vec3 size{std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)};
      const auto [low, high] = std::minmax({dot(axis, v[0]), dot(axis, v[1]), dot(axis, v[2])});
      const double bound = dot(size, half_) + kSlack * dot(size, reach);
      return low > bound || high < -bound;
    };
    if (apart({1, 0, 0}) || apart({0, 1, 0}) || apart({0, 0, 1}) || apart(normal_)) return false;
    for (const Vec3& e : edges_)
      if (apart({0, -e.z, e.y}) || apart({e.z, 0, -e.x}) || apart({-e.y, e.x, 0})) return false;
    return true;
  }

 private:
  static constexpr double kSlack = 1e-14;

  std::array<Vec3, 3> t_;
  Vec3 half_;
  std::array<Vec3, 3> edges_;
  Vec3 normal_;
};

// Up to this coordinate, products of three differences are finite.
constexpr double kMostVoxelCoordinate = 1e100;

// The voxels begin <= n < end along an axis.
struct VoxelRange {
  std::int64_t begin, end;
};

class Painter {
 public:
  explicit Painter(Occupancy& voxels)
      : voxels_(voxels),
        half_(voxels.grid.spacing * 0.5),
        axes_{SampleAxis(axis_of(voxels.grid, 0)), SampleAxis(axis_of(voxels.grid, 1)),
              SampleAxis(axis_of(voxels.grid, 2))} {}

  // Visits the columns of voxels across the triangle, and in each the voxels near the triangle's plane.
  void paint(const std::array<Vec3, 3>& t, ProgressMeter& meter) const {
    const TriangleInVoxels triangle(t, half_);
    const Vec3& n = triangle.normal();
    const double size[3] = {std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    const std::size_t a = size[0] >= size[1] && size[0] >= size[2] ? 0
                          : size[1] >= size[2]                     ? 1
                                                                   : 2,
                      b = (a + 1) % 3, c = (a + 2) % 3;
    const VoxelRange across_a = range_of(t, a), across_b = range_of(t, b), across_c = range_of(t, c);
    const bool has_plane = triangle.normal_is_good();
    std::array<std::int64_t, 3> at;
    for (at[c] = across_c.begin; at[c] < across_c.end; ++at[c]) {
      meter.check();
      for (at[b] = across_b.begin; at[b] < across_b.end; ++at[b]) {
        const VoxelRange near = has_plane ? near_plane(t, n, {a, b, c}, at, across_a) : across_a;
        for (at[a] = near.begin; at[a] < near.end; ++at[a])
          if (triangle.overlaps({axes_[0].at(at[0]), axes_[1].at(at[1]), axes_[2].at(at[2])})) mark(at);
      }
    }
  }

 private:
  // The voxels that hold a number from low to high, and one more on each side.
  VoxelRange holding(double low, double high, std::size_t axis) const {
    const double half = half_[axis];
    const SampleAxis& samples = axes_[axis];
    return {std::max<std::int64_t>(0, samples.first_from(low - half) - 1),
            std::min(samples.size(), samples.first_from(high + half) + 1)};
  }
  VoxelRange range_of(const std::array<Vec3, 3>& t, std::size_t axis) const {
    const auto [low, high] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
    return holding(low, high, axis);
  }
  // The voxels near the plane in the column along axes[0] through `at`. The normal is largest along that axis, and
  // accurate to 1e-11.
  VoxelRange near_plane(const std::array<Vec3, 3>& t, const Vec3& n, const std::array<std::size_t, 3>& axes,
                        const std::array<std::int64_t, 3>& at, const VoxelRange& all) const {
    const auto [a, b, c] = axes;
    const double u = axes_[b].at(at[b]) - t[0][b], v = axes_[c].at(at[c]) - t[0][c];
    const double slope_b = n[b] / n[a], slope_c = n[c] / n[a];
    const double middle = t[0][a] - slope_b * u - slope_c * v;
    const double reach = std::abs(slope_b) * half_[b] + std::abs(slope_c) * half_[c] +
                         1e-10 * (std::abs(u) + std::abs(v) + half_[b] + half_[c]);
    const VoxelRange near = holding(middle - reach, middle + reach, a);
    return {std::max(near.begin, all.begin), std::min(near.end, all.end)};
  }

  void mark(const std::array<std::int64_t, 3>& at) const {
    const std::int64_t byte = (at[2] * voxels_.grid.size.y + at[1]) * voxels_.row_bytes() + at[0] / 8;
    const std::atomic_ref bits(voxels_.bits[static_cast<std::size_t>(byte)]);
    const auto bit = static_cast<std::uint8_t>(1 << (at[0] % 8));
    if (!(bits.load(std::memory_order_relaxed) & bit)) bits.fetch_or(bit, std::memory_order_relaxed);
  }

  Occupancy& voxels_;
  Vec3 half_;
  std::array<SampleAxis, 3> axes_;
};

void check_voxel_coordinates(const Box& box) {
  if (!(std::max(max_norm(box.min), max_norm(box.max)) <= kMostVoxelCoordinate))
    throw Error(ErrorCode::limit,
                "voxels: mesh or grid reach beyond " + number_text(kMostVoxelCoordinate) + "; scale them down");
}

}  // namespace

Occupancy surface_voxels(MeshView mesh, const Grid& grid, const SurfaceVoxelOptions& options) try {
  validate("voxels", options.execution, Runs::on_the_cpu);
  validate(grid);
  validate(mesh);
  check_voxel_coordinates(bounds(mesh));
  check_voxel_coordinates(grid.bounds());
  Occupancy voxels{grid, {}, {}};
  voxels.bits.resize(static_cast<std::size_t>(voxels.row_bytes() * grid.size.y * grid.size.z));
  ProgressMeter meter(options.progress);
  Threads(options.execution.threads).run([&] {
    constexpr std::size_t kGrain = 256;
    const Painter painter(voxels);
    meter.stage("voxels", static_cast<std::int64_t>(mesh.triangles.size()), 0, 1);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), kGrain), [&](const auto& range) {
      for (std::size_t n = range.begin(); n != range.end(); ++n) painter.paint(mesh.corners(n), meter);
      meter.advance(static_cast<std::int64_t>(range.size()));
    });
  });
  meter.stage("done", 1, 1, 1);
  return voxels;
} catch (...) {
  throw_as_error("voxels", "take fewer samples, or provide more memory");
}

void add_voxels(Occupancy& to, const Occupancy& more) try {
  if (!(to.grid == more.grid) || to.bits.size() != more.bits.size())
    throw Error(ErrorCode::usage, "voxels: both must be of the same grid; make them with one");
  for (std::size_t n = 0; n < to.bits.size(); ++n) to.bits[n] |= more.bits[n];
} catch (...) {
  throw_as_error("voxels");
}

}  // namespace standoff
