// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/orient.h"

#include <algorithm>

#include "sign/diagnosis/copies.h"
#include "sign/diagnosis/edge_sides.h"
#include "sign/diagnosis/nesting.h"
#include "sign/diagnosis/patches.h"
#include "sign/diagnosis/pieces.h"
#include "sign/diagnosis/solid.h"
#include "sign/diagnosis/two_sided_parts.h"

namespace standoff {
namespace {

struct PieceSize {
  Box bounds;
  PartSums sums;
};

std::vector<PieceSize> sizes_of(const OrientedMesh& mesh, const Pieces& pieces) {
  std::vector<PieceSize> sizes(pieces.size());
  for (std::size_t t = 0; t < pieces.of.size(); ++t)
    for (const Vec3& corner : mesh.mesh.corners(t)) sizes[pieces.of[t]].bounds.include(corner);
  for (std::size_t t = 0; t < pieces.of.size(); ++t) {
    if (mesh.use_of(t) == 0) continue;
    PieceSize& size = sizes[pieces.of[t]];
    const auto [a, b, c] = mesh.corners(t);
    size.sums.add(a, b, c, size.bounds.center());
  }
  return sizes;
}

std::vector<Part> parts_of(const Pieces& pieces, const std::vector<PieceSize>& sizes) {
  std::vector<Part> parts;
  for (std::size_t n = 0; n < pieces.size(); ++n)
    parts.push_back({sizes[n].bounds, pieces.unorientable[n] == 0 && is_solid(sizes[n].sums, pieces.closed[n] != 0)});
  return parts;
}

// For each piece -1 if it is to be turned, else 1.
std::vector<std::int8_t> turns_of(const std::vector<Part>& parts, const std::vector<PieceSize>& sizes,
                                  const Nesting& nesting) {
  // The sign of the volume of the outermost piece around each, 0 while it is unknown.
  std::vector<std::int8_t> outermost(parts.size());
  std::vector<std::uint32_t> inwards;
  for (std::uint32_t n = 0; n < parts.size(); ++n) {
    std::uint32_t at = n;
    for (inwards.clear(); outermost[at] == 0; at = nesting.parent[at]) {
      inwards.push_back(at);
      if (nesting.parent[at] == Nesting::kNone) {
        outermost[at] = sizes[at].sums.volume < 0 ? -1 : 1;
        break;
      }
    }
    for (const std::uint32_t piece : inwards) outermost[piece] = outermost[at];
  }
  std::vector<std::int8_t> turns(parts.size(), 1);
  for (std::size_t n = 0; n < parts.size(); ++n) {
    if (!parts[n].solid) continue;
    const bool inside_out = sizes[n].sums.volume * outermost[n] < 0;
    turns[n] = static_cast<std::int8_t>(inside_out && nesting.depth[n] % 2 == 0 ? -outermost[n] : outermost[n]);
  }
  return turns;
}

// Turns the pieces with a volume outwards. Returns whether their nesting is known.
bool turn_outwards(MeshView mesh, const Pieces& pieces, std::vector<std::int8_t>& use) {
  const std::vector<PieceSize> sizes = sizes_of({mesh, use}, pieces);
  const std::vector<Part> parts = parts_of(pieces, sizes);
  const auto is_inside_out = [&](std::size_t n) { return parts[n].solid && sizes[n].sums.volume < 0; };
  bool any = false;
  for (std::size_t n = 0; n < parts.size(); ++n) any = any || is_inside_out(n);
  if (!any) return true;
  const Nesting nesting = find_nesting({mesh, use}, pieces.of, parts);
  if (!nesting.known) return false;
  const std::vector<std::int8_t> turns = turns_of(parts, sizes, nesting);
  for (std::size_t t = 0; t < use.size(); ++t) use[t] = static_cast<std::int8_t>(use[t] * turns[pieces.of[t]]);
  return true;
}

std::int64_t boundary_edges(const MeshEdges& edges, const std::vector<std::int8_t>& use) {
  std::int64_t count = 0;
  for_each_edge(edges, use, [&](std::span<const EdgeUse> sides) {
    std::int64_t excess = 0;
    for (const EdgeUse& side : sides) excess += side.forward ? use[side.triangle] : -use[side.triangle];
    count += excess != 0;
  });
  return count;
}

// Two-sided parts of which most is not used, on either side.
void add_cancelled(MeshView mesh, const TwoSidedParts& parts, const Copies& copies, Orientation& found) {
  if (parts.size() == 0) return;
  double all = 0, cancelled = 0;
  std::vector<double> used(parts.size()), left_out(parts.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    const double area = length(cross(b - a, c - a)) / 2;
    all += area;
    if (parts.of[t] != TwoSidedParts::kNone) (copies.use[t] != 0 ? used : left_out)[parts.of[t]] += area;
  }
  for (std::size_t n = 0; n < parts.size(); ++n) {
    // Of a surface that counts once, as much is used as left out.
    if (!(left_out[n] > 3 * used[n])) continue;
    ++found.cancelled_parts;
    cancelled += left_out[n];
  }
  if (all > 0) found.cancelled_share = cancelled / all;
}

// Patches of one triangle that is left out, or whose corners are not three positions, are none.
std::int64_t patches_in_use(const MeshEdges& edges, const Patches& patches) {
  auto count = static_cast<std::int64_t>(patches.size());
  for (std::size_t t = 0; t < patches.of.size(); ++t) {
    const std::uint32_t a = edges.position(t, 0), b = edges.position(t, 1), c = edges.position(t, 2);
    count -= patches.turn[t] == 0 || a == b || b == c || c == a;
  }
  return count;
}

}  // namespace

Orientation orient(MeshView mesh, const MeshEdges& edges) {
  const std::size_t triangles = mesh.triangles.size();
  Orientation found;
  found.inconsistent_before = inconsistent_edges(edges, {});
  Copies copies = find_copies(edges, triangles, {});
  const TwoSidedParts parts = find_two_sided_parts(mesh, edges, copies);
  if (std::ranges::count(parts.kept, 1) > 0) copies = find_copies(edges, triangles, parts);
  add_cancelled(mesh, parts, copies, found);
  found.repeated = copies.repeated;
  found.same = copies.same;
  found.opposite = copies.opposite;
  found.two_sided = copies.two_sided;

  Patches patches = find_patches(edges, copies, triangles);
  found.patches = patches_in_use(edges, patches);
  found.unorientable = std::ranges::count(patches.unorientable, 1);
  const Pieces pieces = find_pieces(mesh, edges, patches);
  found.use = std::move(patches.turn);
  found.nesting_known = turn_outwards(mesh, pieces, found.use);

  // Of two opposite copies that one is used which need not be flipped.
  for (const auto& [kept, opposite] : copies.either)
    if (found.use[kept] < 0) {
      found.use[kept] = 0;
      found.use[opposite] = 1;
    }
  found.flipped = std::ranges::count(found.use, -1);
  found.left_out = copies.left_out + pieces.walls;
  found.walls = pieces.walls;
  found.inconsistent_after = inconsistent_edges(edges, found.use);
  found.boundary_edges = boundary_edges(edges, found.use);
  // A mesh that needs nothing is used as it is, with the pairs that cancel each other.
  if (found.flipped == 0 && found.walls == 0 && copies.same_winding) {
    found.use.clear();
    found.left_out = 0;
  }
  return found;
}

}  // namespace standoff
