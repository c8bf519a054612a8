// SPDX-License-Identifier: Apache-2.0
#include "sign/flood/grid_edges.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/progress.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "geometry/predicates.h"
#include "sign/diagnosis/mesh_edges.h"

namespace standoff {

// Distances from rims.

namespace {

constexpr std::int64_t kRimTileSide = DistanceField::kTileSide;
using LatticeSample = std::array<std::int64_t, 3>;

// The distance of two segments. If their lines have no common perpendicular between them, one of the nearest points is
// an end.
double segment_distance(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q) {
  const Vec3 u = b - a, v = q - p, w = a - p;
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w);
  const auto ratio = [](double above, double below) { return below > 0 ? std::clamp(above / below, 0.0, 1.0) : 0.0; };
  double s = ratio(uv * vw - uw * vv, uu * vv - uv * uv);
  const double t = ratio(vw + s * uv, vv);
  s = ratio(t * uv - uw, uu);
  return length(w + u * s - v * t);
}

// The samples whose edges along an axis may come as near to a rim as `reach`.
struct NearEdges {
  LatticeSample first, past;

  std::int64_t count() const {
    std::int64_t product = 1;
    for (std::size_t n = 0; n < 3; ++n) product *= std::max<std::int64_t>(0, past[n] - first[n]);
    return product;
  }
};

NearEdges near_edges_of(const RimEdge& rim, double reach, const TileLattice& lattice, std::size_t along) {
  NearEdges found;
  for (std::size_t n = 0; n < 3; ++n) {
    const LatticeAxis& axis = lattice.axes[n];
    const auto [low, high] = std::minmax({rim[0][n], rim[1][n]});
    found.first[n] = axis.first_from(low - reach) - (n == along);
    found.past[n] = axis.first_from(high + reach);
    if (n == along) {
      found.first[n] = std::max<std::int64_t>(0, found.first[n]);
      found.past[n] = std::min(found.past[n], axis.size() - 1);
    }
  }
  return found;
}

// Calls use(axis, rim, candidates) for pieces of a rim: so small that most of their candidates are within reach.
template <class Use>
void for_each_piece(const RimEdge& rim, double reach, const TileLattice& lattice, const Use& use) {
  constexpr std::int64_t kMostCandidates = 64;
  constexpr int kMostHalvings = 60;
  const auto visit = [&](const auto& self, std::size_t axis, const RimEdge& piece, int halvings) -> void {
    const NearEdges candidates = near_edges_of(piece, reach, lattice, axis);
    if (candidates.count() == 0) return;
    if (candidates.count() <= kMostCandidates || halvings == 0) return use(axis, piece, candidates);
    const Vec3 middle = piece[0] + (piece[1] - piece[0]) * 0.5;
    self(self, axis, {piece[0], middle}, halvings - 1);
    self(self, axis, {middle, piece[1]}, halvings - 1);
  };
  // Stop at pieces as short as `reach`: shorter ones have no fewer candidates.
  const double pieces = length(rim[1] - rim[0]) / reach;
  const int halvings = pieces > 1 ? std::min(kMostHalvings, static_cast<int>(std::ceil(std::log2(pieces)))) : 0;
  for (std::size_t axis = 0; axis < 3; ++axis) visit(visit, axis, rim, halvings);
}

// Triangles of less height, as a share of the mesh's longest side, belong to no surface that could have a gap beside
// them: needles, and triangles that rounding gave an area.
constexpr double kThinTriangle = 1e-6;

// The height of a triangle, in units of 1 / scale, so that nothing overflows.
double height_of(const Corners& t, double scale) {
  const Vec3 u = (t[1] - t[0]) * scale, v = (t[2] - t[0]) * scale;
  const double longest = std::max({length(u), length(v), length(u - v)});
  return longest > 0 ? length(cross(u, v)) / longest : 0;
}

template <class Use>
void for_each_rim(std::span<const RimEdge> rims, ProgressMeter& progress, const Use& use) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rims.size(), 256), [&](const auto& range) {
    progress.check();
    for (std::size_t n = range.begin(); n != range.end(); ++n) use(rims[n]);
  });
}

}  // namespace

std::vector<RimEdge> rim_edges_of(MeshView mesh, ProgressMeter& progress) {
  const double scale = 1 / max_norm(bounds(mesh).extent());
  std::vector<std::uint8_t> is_thin(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, is_thin.size(),
                    [&](std::size_t t) { is_thin[t] = height_of(mesh.corners(t), scale) <= kThinTriangle; });
  std::vector<RimEdge> rims;
  for_each_edge(MeshEdges(mesh, progress), {}, [&](std::span<const HalfEdge> sides) {
    const auto thick = std::ranges::count_if(sides, [&](const HalfEdge& side) { return !is_thin[side.triangle]; });
    if (sides.size() % 2 == 0 || thick % 2 == 0) return;
    const auto corners = mesh.corners(sides.front().triangle);
    const std::size_t corner = sides.front().corner;
    rims.push_back({corners[corner], corners[(corner + 1) % 3]});
  });
  return rims;
}

RimDistances::RimDistances(std::span<const RimEdge> rims, const TileLattice& lattice, double reach,
                           ProgressMeter& progress)
    : tiles_(lattice.tile_count()) {
  for_each_rim(rims, progress, [&](const RimEdge& rim) {
    for_each_piece(rim, reach, lattice, [&](std::size_t, const RimEdge&, const NearEdges& found) {
      for (std::int64_t z = found.first[2] / kRimTileSide; z <= (found.past[2] - 1) / kRimTileSide; ++z)
        for (std::int64_t y = found.first[1] / kRimTileSide; y <= (found.past[1] - 1) / kRimTileSide; ++y)
          for (std::int64_t x = found.first[0] / kRimTileSide; x <= (found.past[0] - 1) / kRimTileSide; ++x)
            tiles_.add(lattice.index(x, y, z));
    });
  });
  tiles_.number_them();
  Steps far;
  for (auto& axis : far) axis.fill(kFar);
  steps_.assign(tiles_.count(), far);
  const double per_step = kFar / reach;
  const auto position = [&](const LatticeSample& s) {
    return Vec3{lattice.axes[0].at(s[0]), lattice.axes[1].at(s[1]), lattice.axes[2].at(s[2])};
  };
  for_each_rim(rims, progress, [&](const RimEdge& rim) {
    for_each_piece(rim, reach, lattice, [&](std::size_t axis, const RimEdge& piece, const NearEdges& found) {
      LatticeSample at;
      for (at[2] = found.first[2]; at[2] < found.past[2]; ++at[2])
        for (at[1] = found.first[1]; at[1] < found.past[1]; ++at[1])
          for (at[0] = found.first[0]; at[0] < found.past[0]; ++at[0]) {
            LatticeSample to = at;
            ++to[axis];
            const double steps = segment_distance(piece[0], piece[1], position(at), position(to)) * per_step;
            if (!(steps < kFar)) continue;
            const std::size_t tile = lattice.index(at[0] / kRimTileSide, at[1] / kRimTileSide, at[2] / kRimTileSide);
            const auto sample = static_cast<std::size_t>(
                at[0] % kRimTileSide + kRimTileSide * (at[1] % kRimTileSide + kRimTileSide * (at[2] % kRimTileSide)));
            const std::atomic_ref<std::uint16_t> least(steps_[tiles_.number(tile)][axis][sample]);
            const auto mine = static_cast<std::uint16_t>(steps);
            std::uint16_t seen = least.load(std::memory_order_relaxed);
            while (mine < seen && !least.compare_exchange_weak(seen, mine, std::memory_order_relaxed)) {
            }
          }
    });
  });
}

TileEdges RimDistances::nearer_than(std::uint16_t steps, std::size_t tile) const {
  TileEdges edges;
  if (!tiles_.has(tile)) return edges;
  const Steps& found = steps_[tiles_.number(tile)];
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t n = 0; n < found[axis].size(); ++n)
      edges.crossed[axis][n / 64] |= std::uint64_t{found[axis][n] < steps} << n % 64;
  return edges;
}

// Crossed edges.

namespace {

// An edge as a number: its tile above 11 bits for axis and sample.
using GridEdgeKey = std::uint64_t;

GridEdgeKey key_of(const TileLattice& lattice, std::size_t axis, const std::array<std::int64_t, 3>& sample) {
  const auto [x, y, z] = sample;
  const auto within =
      static_cast<GridEdgeKey>(x % kTileSide + kTileSide * (y % kTileSide) + kTileSide * kTileSide * (z % kTileSide));
  return GridEdgeKey{lattice.index(x / kTileSide, y / kTileSide, z / kTileSide)} << 11 | GridEdgeKey{axis} << 9 |
         within;
}

}  // namespace

GridEdges::GridEdges(MeshView mesh, const TileLattice& lattice, ProgressMeter& progress)
    : tiles_(lattice.tile_count()) {
  constexpr std::size_t kGrain = 4096;
  PerThread<std::vector<GridEdgeKey>> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), kGrain), [&](const auto& range) {
    WorkCheck check(progress, 1 << 14);
    std::vector<GridEdgeKey>& mine = found.local();
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      check.add(4);  // about as long as four edges
      for_each_crossed_edge(mesh.corners(t), lattice.axes, [&](std::size_t axis, const auto& sample) {
        mine.push_back(key_of(lattice, axis, sample));
        check.add(1);
      });
    }
  });

  const auto for_each_key = [&](const auto& use) {
    found.for_each([&](const std::vector<GridEdgeKey>& part) {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part.size(), 4 * kGrain), [&](const auto& range) {
        for (std::size_t n = range.begin(); n != range.end(); ++n) use(part[n]);
      });
    });
  };
  for_each_key([&](GridEdgeKey key) { tiles_.add(key >> 11); });
  tiles_.number_them();
  edges_.resize(tiles_.count());
  for_each_key([&](GridEdgeKey key) {
    TileEdges& edges = edges_[tiles_.number(key >> 11)];
    std::uint64_t& word = edges.crossed[key >> 9 & 3][key >> 6 & 7];
    std::atomic_ref(word).fetch_or(std::uint64_t{1} << (key & 63), std::memory_order_relaxed);
  });
}

GridEdges::GridEdges(const GridEdges& crossed, const RimDistances& rims, std::uint16_t steps,
                     const TileLattice& lattice)
    : tiles_(lattice.tile_count()) {
  for (const TileSet* const some : {&crossed.tiles(), &rims.tiles()})
    some->for_each([&](std::size_t tile) { tiles_.add(tile); });
  tiles_.number_them();
  edges_.resize(tiles_.count());
  tiles_.for_each([&](std::size_t tile) {
    TileEdges& edges = edges_[tiles_.number(tile)];
    edges = rims.nearer_than(steps, tile);
    for (std::size_t axis = 0; axis < 3; ++axis)
      edges.crossed[axis] = edges.crossed[axis] | crossed.of_tile(tile).crossed[axis];
  });
}

}  // namespace standoff
