// SPDX-License-Identifier: Apache-2.0
#include "sign/row_crossings.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/per_thread.h"
#include "core/tile_count.h"
#include "sign/first_from_guess.h"
#include "sign/ray_crossing.h"

namespace standoff {
namespace {

constexpr std::int64_t kSide = InsideRows::kSide;

// The samples of one axis, as Grid::position gives them.
class Axis {
 public:
  Axis(double origin, double spacing, std::int64_t size)
      : origin_(origin), spacing_(spacing), per_spacing_(1 / spacing), size_(size) {}

  std::int64_t size() const { return size_; }
  double at(std::int64_t n) const { return origin_ + spacing_ * static_cast<double>(n); }
  // The first sample for which is_true, which stays true: near `value`, or the number of samples.
  template <class Predicate>
  std::int64_t first(double value, const Predicate& is_true) const {
    return first_from_guess(guess(value), size_, is_true);
  }
  // The first sample at or above `value`, or the number of samples.
  std::int64_t first_from(double value) const {
    return first(value, [&](std::int64_t n) { return at(n) >= value; });
  }

 private:
  // Rounded up without ceil(), which is a call where there is no SSE4.1.
  std::int64_t guess(double value) const {
    const double sample = (value - origin_) * per_spacing_;
    if (!(sample > 0)) return 0;
    if (!(sample < static_cast<double>(size_))) return size_;
    const auto below = static_cast<std::int64_t>(sample);
    return below + (static_cast<double>(below) < sample);
  }

  double origin_, spacing_, per_spacing_;
  std::int64_t size_;
};

// A crossing and the row of tiles that it belongs to.
struct Found {
  std::size_t tiles;
  RowCrossing crossing;
};

class Scan {
 public:
  Scan(const OrientedMesh& mesh, const Grid& grid)
      : mesh_(mesh),
        x_{grid.origin.x, grid.spacing.x, grid.size.x},
        y_{grid.origin.y, grid.spacing.y, grid.size.y},
        z_{grid.origin.z, grid.spacing.z, grid.size.z},
        tiles_y_(tiles_along(grid.size.y)) {}

  void add(std::size_t triangle, std::vector<Found>& found) const {
    if (mesh_.use_of(triangle) == 0) return;
    const std::array<Vec3, 3> t = mesh_.corners(triangle);
    // Half open: a row at the largest y or z passes beside the triangle.
    const std::int64_t first_y = y_.first_from(std::min({t[0].y, t[1].y, t[2].y})),
                       past_y = y_.first_from(std::max({t[0].y, t[1].y, t[2].y}));
    if (first_y == past_y) return;
    const std::int64_t first_z = z_.first_from(std::min({t[0].z, t[1].z, t[2].z})),
                       past_z = z_.first_from(std::max({t[0].z, t[1].z, t[2].z}));
    if (first_z == past_z) return;
    const RayTriangle ray(t);
    for (std::int64_t k = first_z; k < past_z; ++k)
      for (std::int64_t j = first_y; j < past_y; ++j) {
        const double y = y_.at(j), z = z_.at(k);
        const int crossing = ray.crossing(y, z);
        if (crossing == 0) continue;
        const std::int64_t past = x_.first(ray.crossing_x(y, z), [&](std::int64_t n) {
          return ray.is_past({x_.at(n), y, z}, crossing);
        });
        if (past == x_.size()) continue;
        const auto row = static_cast<int>(j % kSide + kSide * (k % kSide));
        found.push_back(
            {static_cast<std::size_t>(j / kSide + tiles_y_ * (k / kSide)), RowCrossing::make(row, past, crossing)});
      }
  }

 private:
  OrientedMesh mesh_;
  Axis x_, y_, z_;
  std::int64_t tiles_y_;
};

}  // namespace

RowCrossings::RowCrossings(const OrientedMesh& mesh, const Grid& grid, ProgressMeter& progress)
    : tiles_y_(tiles_along(grid.size.y)), begin_(static_cast<std::size_t>(tiles_y_ * tiles_along(grid.size.z)) + 1) {
  constexpr std::size_t kGrain = 4096;
  const Scan scan(mesh, grid);
  PerThread<std::vector<Found>> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.mesh.triangles.size(), kGrain), [&](const auto& range) {
    progress.check();
    std::vector<Found>& mine = found.local();
    for (std::size_t t = range.begin(); t != range.end(); ++t) scan.add(t, mine);
  });

  // Sorted by row of tiles: each thread's crossings are counted, then each has places of its own.
  std::vector<const std::vector<Found>*> parts;
  found.for_each([&](const std::vector<Found>& part) { parts.push_back(&part); });
  const std::size_t rows = begin_.size() - 1;
  std::vector<std::vector<std::size_t>> next(parts.size());
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t n) {
    next[n].resize(rows);
    for (const Found& one : *parts[n]) ++next[n][one.tiles];
  });
  std::size_t total = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    begin_[row] = total;
    for (auto& places : next) total += std::exchange(places[row], total);
  }
  begin_[rows] = total;
  crossings_.resize(total);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t n) {
    for (const Found& one : *parts[n]) crossings_[next[n][one.tiles]++] = one.crossing;
  });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows, 64), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n)
      std::sort(crossings_.begin() + static_cast<std::ptrdiff_t>(begin_[n]),
                crossings_.begin() + static_cast<std::ptrdiff_t>(begin_[n + 1]));
  });
}

}  // namespace standoff
