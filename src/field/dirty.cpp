// SPDX-License-Identifier: Apache-2.0
#include "field/dirty.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "core/threads.h"
#include "core/tile_count.h"
#include "field/lattice.h"
#include "geometry/triangle_box.h"
#include "standoff/error.h"

namespace standoff {

// Which triangles changed.

namespace {

// Throws as validate() does of triangles of a mesh.
void check_triangle(const MeshView& mesh, std::uint32_t triangle, const char* which) {
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorCode::input,
                std::string("update: triangle ") + std::to_string(triangle) + " of the mesh " + which + ": " + what +
                    "; repair the mesh",
                {.triangle = triangle});
  };
  for (const std::uint32_t vertex : mesh.triangles[triangle]) {
    if (vertex >= mesh.vertices.size()) fail("an index is out of range");
    if (!is_finite(mesh.vertices[vertex])) fail("vertex " + std::to_string(vertex) + " is not finite");
  }
}

bool same_corners(const MeshView& a, const MeshView& b, std::uint32_t triangle) {
  const auto one = a.corners(triangle), other = b.corners(triangle);
  return std::memcmp(&one, &other, sizeof one) == 0;
}

}  // namespace

MeshChange change_of(MeshView before, MeshView after, std::span<const std::uint32_t> listed) {
  const auto [fewer, more] = std::minmax({before.triangles.size(), after.triangles.size()});
  MeshChange change{before, after, {listed.begin(), listed.end()}};
  std::vector<std::uint32_t>& triangles = change.triangles;
  for (std::size_t t = fewer; t < more; ++t) triangles.push_back(static_cast<std::uint32_t>(t));
  if (!std::ranges::is_sorted(triangles)) std::ranges::sort(triangles);
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  if (!triangles.empty() && triangles.back() >= more)
    throw Error(ErrorCode::usage, "update: triangle " + std::to_string(triangles.back()) +
                                      " is said to have changed, but neither mesh has it; they have " +
                                      std::to_string(before.triangles.size()) + " and " +
                                      std::to_string(after.triangles.size()) + "; name triangles of the meshes");
  for (const std::uint32_t t : triangles) {
    if (change.is_in(before, t)) check_triangle(before, t, "before");
    if (change.is_in(after, t)) check_triangle(after, t, "after");
  }
  std::erase_if(triangles, [&](std::uint32_t t) { return t < fewer && same_corners(before, after, t); });
  return change;
}

namespace {

bool touch(const Box& a, const Box& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z &&
         b.min.z <= a.max.z;
}

}  // namespace

double rounding_of_places(const Grid& grid) {
  const Box box = grid.bounds();
  const double farthest = std::max(max_norm(box.min), max_norm(box.max));
  return grid.max_spacing() / 64 + 64 * std::numeric_limits<double>::epsilon() * farthest;
}

// Dirty tiles.

namespace {

std::int64_t bricks_along(std::int64_t samples) { return (samples + kBrickSide - 1) / kBrickSide; }

Size3 size_in_bricks(const Grid& grid) {
  return {bricks_along(grid.size.x), bricks_along(grid.size.y), bricks_along(grid.size.z)};
}

}  // namespace

void DirtyTiles::Marks::set(const Size3& low, const Size3& high, std::uint8_t mark) {
  for (std::int64_t z = low.z; z < high.z; ++z)
    for (std::int64_t y = low.y; y < high.y; ++y)
      std::memset(&marks[index(low.x, y, z)], mark, static_cast<std::size_t>(high.x - low.x));
}

bool DirtyTiles::Marks::has(const Size3& low, const Size3& high, std::uint8_t mark) const {
  for (std::int64_t z = low.z; z < high.z; ++z)
    for (std::int64_t y = low.y; y < high.y; ++y) {
      const auto row = marks.begin() + static_cast<std::ptrdiff_t>(index(0, y, z));
      if (std::find(row + low.x, row + high.x, mark) != row + high.x) return true;
    }
  return false;
}

DirtyTiles::DirtyTiles(const Grid& grid)
    : grid_(grid), finder_(grid), tiles_(DistanceField::tiles_of(grid.size)), bricks_(size_in_bricks(grid)) {}

TileFinder::TileFinder(const Grid& grid)
    : bounds_(grid.bounds().grown(rounding_of_places(grid))),
      corner_(grid.corner()),
      inset_(grid.spacing * (63.0 / 64)) {
  const Size3 tiles = DistanceField::tiles_of(grid.size);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    per_tile_[axis] = 1 / (kTileSide * grid.spacing[axis]);
    last_[axis] = static_cast<double>(tiles[axis] - 1);
  }
}

TileFinder::Range TileFinder::around(const Box& box) const {
  if (!touch(box, bounds_)) return {};
  Range tiles;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    tiles.low[axis] = at(box.min[axis] + inset_[axis], axis);
    tiles.high[axis] = at(box.max[axis], axis) + 1;
  }
  return tiles;
}

void DirtyTiles::mark_tiles(const TileFinder::Range& tiles) {
  const auto& [low, high] = tiles;
  tiles_.set(low, high, 1);
  bricks_.set({low.x / 2, low.y / 2, low.z / 2}, {(high.x + 1) / 2, (high.y + 1) / 2, (high.z + 1) / 2}, 1);
}

bool DirtyTiles::any_near(const Box& box) const {
  const auto [low, high] = finder_.around(box);
  return tiles_.any(low, high);
}

std::vector<std::uint8_t> DirtyTiles::marks_of(const Grid& window) const {
  const Size3 size = DistanceField::tiles_of(window.size);
  const auto first = [&](std::size_t axis) { return (window.first[axis] - grid_.first[axis]) / kTileSide; };
  std::vector<std::uint8_t> marks;
  marks.reserve(static_cast<std::size_t>(size.count()));
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y) {
      const auto row =
          tiles_.marks.begin() + static_cast<std::ptrdiff_t>(tiles_.index(first(0), first(1) + y, first(2) + z));
      marks.insert(marks.end(), row, row + size.x);
    }
  return marks;
}

void DirtyTiles::mark_row(std::int64_t j, std::int64_t k, std::int64_t begin, std::int64_t end) {
  const Size3 low{begin / kTileSide, j / kTileSide, k / kTileSide};
  mark_tiles({low, {tiles_along(end), low.y + 1, low.z + 1}});
}

void DirtyTiles::mark_reached(const MeshChange& change, double reach) {
  const double grow = reach + rounding_of_places(grid_);
  for (const std::uint32_t t : change.triangles)
    for (const MeshView& mesh : {change.before, change.after})
      if (change.is_in(mesh, t)) mark_tiles(finder_.around(triangle_box(mesh, t).grown(grow)));
}

// Takes the first brick that is left, and bricks beside it along x, y and z as far as all of a layer are left.
std::vector<Grid> DirtyTiles::windows() const {
  std::vector<Grid> windows;
  Marks left = bricks_;
  for (auto next = left.marks.begin();; ++next) {
    next = std::find(next, left.marks.end(), std::uint8_t{1});
    if (next == left.marks.end()) return windows;
    const std::int64_t at = next - left.marks.begin();
    const Size3 low{at % left.size.x, at / left.size.x % left.size.y, at / (left.size.x * left.size.y)};
    Size3 high{low.x + 1, low.y + 1, low.z + 1};
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (; high[axis] < left.size[axis]; ++high[axis]) {
        Size3 from = low, to = high;
        from[axis] = high[axis];
        to[axis] = high[axis] + 1;
        if (!left.all(from, to)) break;
      }
    left.set(low, high, 0);
    Size3 first, size;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = kBrickSide * low[axis];
      size[axis] = std::min(kBrickSide * high[axis], grid_.size[axis]) - first[axis];
    }
    windows.push_back(grid_.window(first, size));
  }
}

// The triangles of windows.

namespace {

constexpr std::int32_t kNoWindow = -1;

// Which window has a brick, and which windows a column of bricks along x passes through.
class WindowMap {
 public:
  WindowMap(const DirtyTiles& dirty, std::span<const Grid> windows, double reach)
      : dirty_(dirty),
        windows_(windows),
        bricks_(size_in_bricks(dirty.grid())),
        margin_(rounding_of_places(dirty.grid())),
        reach_(reach) {
    of_brick_.assign(static_cast<std::size_t>(bricks_.count()), kNoWindow);
    of_column_.resize(static_cast<std::size_t>(bricks_.y * bricks_.z));
    for (std::size_t w = 0; w < windows.size(); ++w) add(dirty.grid(), w);
    reached_ = reached_.grown(reach_ + margin_);
    crossed_ = crossed_.grown(margin_);
  }

  // Calls use(window) for windows within reach of the box, some of them again.
  template <class Use>
  void each_near(const Box& box, const Use& use) const {
    if (!touch(box, reached_)) return;
    const double grow = reach_ + margin_;
    const Box grown = box.grown(grow);
    const auto [low, high] = dirty_.finder().around(grown);
    for (std::int64_t z = low.z / 2; 2 * z < high.z; ++z)
      for (std::int64_t y = low.y / 2; 2 * y < high.y; ++y)
        for (std::int64_t x = low.x / 2; 2 * x < high.x; ++x)
          if (const std::int32_t window = of_brick_[cell_index(bricks_, x, y, z)]; window != kNoWindow)
            if (dirty_.any_dirty(
                    {std::max(2 * x, low.x), std::max(2 * y, low.y), std::max(2 * z, low.z)},
                    {std::min(2 * x + 2, high.x), std::min(2 * y + 2, high.y), std::min(2 * z + 2, high.z)}))
              use(window);
  }
  // The same for windows whose rows may cross the box.
  template <class Use>
  void each_crossed(const Box& box, const Use& use) const {
    if (box.min.x > crossed_.max.x || box.min.y > crossed_.max.y || box.max.y < crossed_.min.y ||
        box.min.z > crossed_.max.z || box.max.z < crossed_.min.z)
      return;
    const Box grown = box.grown(margin_);
    for (std::int64_t z = dirty_.finder().at(grown.min.z, 2) / 2, z_end = dirty_.finder().at(grown.max.z, 2) / 2;
         z <= z_end; ++z)
      for (std::int64_t y = dirty_.finder().at(grown.min.y, 1) / 2, y_end = dirty_.finder().at(grown.max.y, 1) / 2;
           y <= y_end; ++y)
        for (const std::int32_t window : of_column_[static_cast<std::size_t>(y + bricks_.y * z)])
          if (grown.min.x <= windows_[static_cast<std::size_t>(window)].bounds().max.x) use(window);
  }

 private:
  void add(const Grid& grid, std::size_t w) {
    const Grid& window = windows_[w];
    Size3 low, high;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = (window.first[axis] - grid.first[axis]) / kBrickSide;
      high[axis] = low[axis] + bricks_along(window.size[axis]);
    }
    for (std::int64_t z = low.z; z < high.z; ++z)
      for (std::int64_t y = low.y; y < high.y; ++y) {
        of_column_[static_cast<std::size_t>(y + bricks_.y * z)].push_back(static_cast<std::int32_t>(w));
        for (std::int64_t x = low.x; x < high.x; ++x)
          of_brick_[cell_index(bricks_, x, y, z)] = static_cast<std::int32_t>(w);
      }
    const Box box = window.bounds();
    for (Box* all : {&reached_, &crossed_}) {
      all->include(box.min);
      all->include(box.max);
    }
  }

  const DirtyTiles& dirty_;
  std::span<const Grid> windows_;
  Size3 bricks_;
  double margin_, reach_;
  Box reached_, crossed_;
  std::vector<std::int32_t> of_brick_;
  std::vector<std::vector<std::int32_t>> of_column_;
};

struct Needed {
  std::int32_t window;
  std::uint32_t triangle;
};

// What one pass over some triangles found, in their order.
struct NeededInChunk {
  std::vector<Needed> near, crossed;
};

// Adds each window of a triangle once: remembers the triangle that a window got last.
class OncePerWindow {
 public:
  explicit OncePerWindow(std::size_t windows) : last_(windows, kNoTriangle) {}
  void add(std::int32_t window, std::uint32_t triangle, std::vector<Needed>& to) {
    if (std::exchange(last_[static_cast<std::size_t>(window)], triangle) != triangle) to.push_back({window, triangle});
  }

 private:
  std::vector<std::uint32_t> last_;
};

}  // namespace

std::vector<WindowTriangles> triangles_of(MeshView mesh, const DirtyTiles& dirty, std::span<const Grid> windows,
                                          double reach, bool with_crossed, ProgressMeter& progress) {
  constexpr std::size_t kChunk = 16384;
  const std::size_t triangles = mesh.triangles.size();
  const WindowMap map(dirty, windows, reach);
  struct Seen {
    OncePerWindow near, crossed;
  };
  PerThread<Seen> seen([&] { return Seen{OncePerWindow(windows.size()), OncePerWindow(windows.size())}; });
  std::vector<NeededInChunk> chunks((triangles + kChunk - 1) / kChunk);
  tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t chunk) {
    progress.check();
    Seen& mine = seen.local();
    NeededInChunk& found = chunks[chunk];
    for (std::size_t t = kChunk * chunk; t < std::min(triangles, kChunk * (chunk + 1)); ++t) {
      const Box box = triangle_box(mesh, t);
      const auto triangle = static_cast<std::uint32_t>(t);
      map.each_near(box, [&](std::int32_t window) { mine.near.add(window, triangle, found.near); });
      if (with_crossed)
        map.each_crossed(box, [&](std::int32_t window) { mine.crossed.add(window, triangle, found.crossed); });
    }
  });
  std::vector<WindowTriangles> all(windows.size());
  for (const NeededInChunk& chunk : chunks) {
    for (const Needed& one : chunk.near) all[static_cast<std::size_t>(one.window)].near.push_back(one.triangle);
    for (const Needed& one : chunk.crossed) all[static_cast<std::size_t>(one.window)].crossed.push_back(one.triangle);
  }
  return all;
}

}  // namespace standoff
