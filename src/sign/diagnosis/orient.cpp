// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/orient.h"

#include <algorithm>

#include "sign/diagnosis/duplicates.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/diagnosis/nesting.h"
#include "sign/diagnosis/patches.h"
#include "sign/oriented_mesh.h"

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
  parts.reserve(pieces.size());
  for (std::size_t n = 0; n < pieces.size(); ++n)
    parts.push_back({sizes[n].bounds, pieces.unorientable[n] == 0 && is_solid(sizes[n].sums, pieces.closed[n] != 0)});
  return parts;
}

// The orientation of each piece: -1 if it must be flipped, else 1.
std::vector<std::int8_t> orientations_of(const std::vector<Part>& parts, const std::vector<PieceSize>& sizes,
                                         const Nesting& nesting) {
  // Find the sign of the volume of the outermost piece around each piece; 0 while it is unknown.
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
  std::vector<std::int8_t> orientations(parts.size(), 1);
  for (std::size_t n = 0; n < parts.size(); ++n) {
    if (!parts[n].solid) continue;
    const bool inside_out = sizes[n].sums.volume * outermost[n] < 0;
    orientations[n] = static_cast<std::int8_t>(inside_out && nesting.depth[n] % 2 == 0 ? -outermost[n] : outermost[n]);
  }
  return orientations;
}

// Orients the pieces with a volume outwards. Returns whether their nesting is known.
bool orient_outwards(MeshView mesh, const Pieces& pieces, std::vector<std::int8_t>& use) {
  const std::vector<PieceSize> sizes = sizes_of({mesh, use}, pieces);
  const std::vector<Part> parts = parts_of(pieces, sizes);
  const auto is_inside_out = [&](std::size_t n) { return parts[n].solid && sizes[n].sums.volume < 0; };
  bool any = false;
  for (std::size_t n = 0; n < parts.size(); ++n) any = any || is_inside_out(n);
  if (!any) return true;
  const Nesting nesting = find_nesting({mesh, use}, pieces.of, parts);
  if (!nesting.known) return false;
  const std::vector<std::int8_t> orientations = orientations_of(parts, sizes, nesting);
  for (std::size_t t = 0; t < use.size(); ++t) use[t] = static_cast<std::int8_t>(use[t] * orientations[pieces.of[t]]);
  return true;
}

std::int64_t boundary_edges(const MeshEdges& edges, const std::vector<std::int8_t>& use) {
  std::int64_t count = 0;
  for_each_edge(edges, use, [&](std::span<const HalfEdge> sides) { count += excess_of(sides, use) != 0; });
  return count;
}

// Counts the two-sided parts of which most is not used, on either side.
void add_cancelled(MeshView mesh, const TwoSidedParts& parts, const Duplicates& duplicates, Orientation& found) {
  if (parts.size() == 0) return;
  double all = 0, cancelled = 0;
  std::vector<double> used(parts.size()), left_out(parts.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double area = area_of(mesh.corners(t));
    all += area;
    if (parts.of[t] != TwoSidedParts::kNone) (duplicates.use[t] != 0 ? used : left_out)[parts.of[t]] += area;
  }
  for (std::size_t n = 0; n < parts.size(); ++n) {
    // A surface that counts once has the same area used as left out.
    if (!(left_out[n] > 3 * used[n])) continue;
    ++found.cancelled_parts;
    cancelled += left_out[n];
  }
  if (all > 0) found.cancelled_share = cancelled / all;
}

// The number of patches, less those of one triangle that is left out or has two equal corners.
std::int64_t patches_in_use(const MeshEdges& edges, const Patches& patches) {
  auto count = static_cast<std::int64_t>(patches.size());
  for (std::size_t t = 0; t < patches.of.size(); ++t) {
    const std::uint32_t a = edges.position(t, 0), b = edges.position(t, 1), c = edges.position(t, 2);
    count -= patches.orientation[t] == 0 || a == b || b == c || c == a;
  }
  return count;
}

}  // namespace

Orientation orient(MeshView mesh, const MeshEdges& edges) {
  const std::size_t triangles = mesh.triangles.size();
  Orientation found{.inconsistent_before = inconsistent_edges(edges, {})};

  // Leave out duplicates.
  Duplicates duplicates = find_duplicates(edges, triangles, {});
  const TwoSidedParts parts = find_two_sided_parts(mesh, edges, duplicates);
  if (std::ranges::count(parts.kept, 1) > 0) duplicates = find_duplicates(edges, triangles, parts);
  add_cancelled(mesh, parts, duplicates, found);
  found.repeated = duplicates.repeated;
  found.same = duplicates.same;
  found.opposite = duplicates.opposite;
  found.two_sided = duplicates.two_sided;

  // Make patches and pieces consistent, and orient pieces outwards.
  Patches patches = find_patches(edges, duplicates, triangles);
  found.patches = patches_in_use(edges, patches);
  found.unorientable = std::ranges::count(patches.unorientable, 1);
  const Pieces pieces = find_pieces(mesh, edges, patches);
  found.use = std::move(patches.orientation);
  found.nesting_known = orient_outwards(mesh, pieces, found.use);

  // Of two opposite copies, use the one that need not be flipped.
  for (const auto& [kept, opposite] : duplicates.either)
    if (found.use[kept] < 0) {
      found.use[kept] = 0;
      found.use[opposite] = 1;
    }

  // Count what was done.
  found.flipped = std::ranges::count(found.use, -1);
  found.left_out = duplicates.left_out + pieces.walls;
  found.walls = pieces.walls;
  found.inconsistent_after = inconsistent_edges(edges, found.use);
  found.boundary_edges = boundary_edges(edges, found.use);

  // Use a mesh that needs nothing as it is, with the pairs that cancel each other.
  if (found.flipped == 0 && found.walls == 0 && duplicates.same_winding) {
    found.use.clear();
    found.left_out = 0;
  }
  return found;
}

}  // namespace standoff
