// SPDX-License-Identifier: Apache-2.0
#include "sign/flood/flood.h"

#include "core/tile_count.h"

namespace standoff {
namespace {

// Calls use(tile, face) for the tiles at each face of the lattice.
template <class Use>
void for_each_outermost(const TileLattice& lattice, const Use& use) {
  const std::array<std::int64_t, 3> tiles{lattice.tiles.x, lattice.tiles.y, lattice.tiles.z};
  for (const Face face : kFaces) {
    const std::size_t b = (face.axis + 1) % 3, c = (face.axis + 2) % 3;
    std::array<std::int64_t, 3> at;
    at[face.axis] = face.up ? tiles[face.axis] - 1 : 0;
    for (at[b] = 0; at[b] < tiles[b]; ++at[b])
      for (at[c] = 0; at[c] < tiles[c]; ++at[c]) use(lattice.index(at[0], at[1], at[2]), face);
  }
}

}  // namespace

Flood::Flood(MeshView mesh, const Grid& grid, ProgressMeter& progress)
    : lattice_(TileLattice::around(grid, bounds(mesh))),
      edges_(mesh, lattice_, progress),
      parts_(edges_.tiles().count()),
      whole_tiles_(lattice_.tile_count()) {
  flood(progress);
  inside_samples_ = count_inside(grid.size);
}

// A tile without crossed edges is reached as a whole. What is reached does not depend on the order of the tiles.
void Flood::flood(ProgressMeter& progress) {
  std::vector<std::size_t> next;
  for_each_outermost(lattice_, [&](std::size_t tile, Face face) { enter(tile, at_face(face), next); });
  const std::array<std::int64_t, 3> tiles{lattice_.tiles.x, lattice_.tiles.y, lattice_.tiles.z};
  const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(tiles[0]),
                                          static_cast<std::size_t>(tiles[0] * tiles[1])};
  for (std::size_t n = 0; !next.empty(); ++n) {
    if (n % 4096 == 0) progress.check();
    const std::size_t tile = next.back();
    next.pop_back();
    const std::array<std::int64_t, 3> at = lattice_.tile_at(tile);
    const TileBits from = reached(tile);
    const bool is_whole = whole_tiles_[tile];
    for (const Face face : kFaces) {
      if (at[face.axis] == (face.up ? tiles[face.axis] - 1 : 0)) continue;
      const std::size_t other = face.up ? tile + stride[face.axis] : tile - stride[face.axis];
      if (whole_tiles_[other]) continue;
      if (is_whole && !edges_.tiles().has(other)) {
        whole_tiles_[other] = true;
        next.push_back(other);
        continue;
      }
      enter(other, beyond(from, face, edges_.of_tile(face.up ? tile : other)), next);
    }
  }
}

void Flood::enter(std::size_t tile, const TileBits& samples, std::vector<std::size_t>& next) {
  if (!any(samples)) return;
  if (!edges_.tiles().has(tile)) {
    if (whole_tiles_[tile]) return;
    whole_tiles_[tile] = true;
    return next.push_back(tile);
  }
  TileBits& part = parts_[edges_.tiles().number(tile)];
  TileBits grown = part | samples;
  if (grown == part) return;
  const TileEdges& edges = edges_.of_tile(tile);
  while (grown != part) {
    part = grown;
    grown = with_neighbours(part, edges);
  }
  next.push_back(tile);
}

TileBits Flood::reached(std::size_t tile) const {
  if (edges_.tiles().has(tile)) return parts_[edges_.tiles().number(tile)];
  return whole_tiles_[tile] ? kAllBits : TileBits{};
}

TileBits Flood::inside_of(const Size3& size, const std::array<std::int64_t, 3>& tile) const {
  const std::size_t index = lattice_.index_in_grid(tile[0], tile[1], tile[2]);
  return whole_tiles_[index] ? TileBits{} : bits_in_grid(size, tile) & ~reached(index);
}

void Flood::fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const {
  for (std::int64_t tx = 0; tx < tiles_along(rows.size().x); ++tx) {
    const TileBits inside = inside_of(rows.size(), {tx, ty, tz});
    if (any(inside)) mark(rows, tx, inside);
  }
}

std::int64_t Flood::count_inside(const Size3& size) const {
  std::int64_t sum = 0;
  for (std::int64_t tz = 0; tz < tiles_along(size.z); ++tz)
    for (std::int64_t ty = 0; ty < tiles_along(size.y); ++ty)
      for (std::int64_t tx = 0; tx < tiles_along(size.x); ++tx) sum += count(inside_of(size, {tx, ty, tz}));
  return sum;
}

}  // namespace standoff
