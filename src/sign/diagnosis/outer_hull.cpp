// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/patches.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

#include "geometry/predicates.h"
#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/oriented_mesh.h"

namespace standoff {

// The patches divide space into cells. A patch has a cell in front of it and one behind; around a nonmanifold edge, two
// faces next to each other by angle share the cell between them, and so all cells follow from the edges (Zhou,
// Grinspun, Zorin, Jacobson 2016, "Mesh arrangements for solid geometry"). The signed volume of the faces around a
// cell, oriented to look out of it, is its volume; but around the unbounded cell they look inwards, and it is negative.
// So the outside is where the volume is negative. (A brim around a ball divides the outside into two cells, since a
// patch's sides are not joined at its free edges: so holes in a hull do not matter.)
//
// This is exact if the patches of a piece meet at edges only, whatever the shape of the rooms: exact predicates compare
// angles. Where patches pass through each other it is a guess. But at nonmanifold edges the hull always closes, because
// the way around one of them passes into the outside as often as out of it. (Unless faces without an area hide that:
// then it may not.) If a patch that is nearly closed passes through others at such an edge, the cells on its two sides
// may be taken for one; then the hull that is found leaves it out, and may be a tiny room beside it.

namespace {

// The two sides of patches, as members of sets: the cells.
std::uint32_t front_of(std::uint32_t patch) { return 2 * patch; }
std::uint32_t back_of(std::uint32_t patch) { return 2 * patch + 1; }

// A face at an edge.
struct HullFace {
  Vec3 third;  // its corner that is not on the edge
  std::uint32_t triangle;
  // The sides of its patch. With the right thumb from the edge's low end to the high one, the fingers point to `ahead`,
  // and come from `behind`.
  std::uint32_t ahead, behind;
  int quarter = 0;
};

// Sorts faces by their angle around an edge, counted from the first one.
class AngleOrder {
 public:
  AngleOrder(const Vec3& low, const Vec3& high) : low_(low), high_(high) {}

  void sort(std::vector<HullFace>& faces) const {
    std::erase_if(faces, [&](const HullFace& face) { return !has_area(face.third); });
    if (faces.empty()) return;
    const Vec3 first = faces.front().third;
    for (HullFace& face : faces) face.quarter = quarter(first, face.third);
    std::ranges::sort(faces, [&](const HullFace& a, const HullFace& b) {
      if (a.quarter != b.quarter) return a.quarter < b.quarter;
      const int turn = a.quarter % 2 == 0 ? 0 : orient3d(low_, high_, a.third, b.third);
      return turn != 0 ? turn > 0 : a.triangle < b.triangle;
    });
  }

 private:
  int flat_side(const Vec3& p, int dropped) const {
    const auto flat = [&](const Vec3& v) {
      return dropped == 0 ? Flat{v.y, v.z} : dropped == 1 ? Flat{v.z, v.x} : Flat{v.x, v.y};
    };
    return orient2d(flat(low_), flat(high_), flat(p));
  }
  bool has_area(const Vec3& p) const { return flat_side(p, 0) != 0 || flat_side(p, 1) != 0 || flat_side(p, 2) != 0; }

  // 0: the angle of the first face; 1: below half a turn from there; 2: half a turn; 3: above.
  int quarter(const Vec3& first, const Vec3& p) const {
    if (const int side = orient3d(low_, high_, first, p)) return side > 0 ? 1 : 3;
    for (int dropped = 0; dropped < 3; ++dropped)
      if (const int side = flat_side(first, dropped)) return flat_side(p, dropped) == side ? 0 : 2;
    return 0;  // not reached: the first one has an area
  }

  Vec3 low_, high_;
};

DisjointSets find_cells(MeshView mesh, const MeshEdges& edges, const Patches& patches) {
  DisjointSets cells(2 * patches.size());
  std::vector<HullFace> faces;
  for_each_edge(edges, patches.orientation, [&](std::span<const HalfEdge> sides) {
    if (sides.size() < 3) return;
    Vec3 low, high;
    faces.clear();
    for (const HalfEdge& side : sides) {
      const auto corners = mesh.corners(side.triangle);
      const auto corner = [&](int n) { return corners[static_cast<std::size_t>((side.corner + n) % 3)]; };
      low = corner(side.forward ? 0 : 1);
      high = corner(side.forward ? 1 : 0);
      const std::uint32_t patch = patches.of[side.triangle];
      const bool forward = side.forward == (patches.orientation[side.triangle] > 0);
      faces.push_back({corner(2), side.triangle, forward ? front_of(patch) : back_of(patch),
                       forward ? back_of(patch) : front_of(patch)});
    }
    AngleOrder(low, high).sort(faces);
    for (std::size_t n = 0; n < faces.size(); ++n) cells.join(faces[n].ahead, faces[(n + 1) % faces.size()].behind);
  });
  return cells;
}

// The sums of each patch. Volumes are relative to the center of its piece.
std::vector<PartSums> sums_of(MeshView mesh, const Patches& patches, std::span<const std::uint32_t> piece_of,
                              std::span<const std::uint8_t> wanted) {
  std::vector<Box> boxes(wanted.size());
  std::vector<PartSums> sums(patches.size());
  const auto for_each = [&](const auto& use) {
    for (std::size_t t = 0; t < patches.of.size(); ++t)
      if (const std::uint32_t piece = piece_of[patches.of[t]]; wanted[piece] != 0 && patches.orientation[t] != 0)
        use(t, piece);
  };
  for_each([&](std::size_t t, std::uint32_t piece) {
    for (const Vec3& corner : mesh.corners(t)) boxes[piece].include(corner);
  });
  for_each([&](std::size_t t, std::uint32_t piece) {
    const auto [a, b, c] = OrientedMesh{mesh, patches.orientation}.corners(t);
    sums[patches.of[t]].add(a, b, c, boxes[piece].center());
  });
  return sums;
}

// The part of a cell's sums that one side of a patch adds.
struct HullShare {
  std::uint32_t piece, cell, side;
  PartSums sums;
};

// For each side of each patch: whether its cell is outside.
std::vector<std::uint8_t> find_outside(std::vector<HullShare> shares, std::size_t patches) {
  std::vector<std::uint8_t> outside(2 * patches);
  std::ranges::sort(shares, {}, [](const HullShare& s) { return std::tuple(s.piece, s.cell, s.side); });
  for (auto next = shares.begin(); next != shares.end();) {
    const auto first = next;
    PartSums cell;
    for (; next != shares.end() && next->piece == first->piece && next->cell == first->cell; ++next)
      cell.add(next->sums, 1);
    if (!is_solid(cell, true) || cell.volume > 0) continue;
    for (auto share = first; share != next; ++share) outside[share->side] = 1;
  }
  return outside;
}

}  // namespace

std::vector<std::int8_t> outer_hulls(MeshView mesh, const MeshEdges& edges, const Patches& patches,
                                     std::span<const std::uint32_t> piece_of, std::span<const std::uint8_t> wanted) {
  std::vector<std::int8_t> hull(patches.size());
  if (std::ranges::count(wanted, 0) == std::ssize(wanted)) return hull;
  DisjointSets cells = find_cells(mesh, edges, patches);
  const std::vector<PartSums> sums = sums_of(mesh, patches, piece_of, wanted);
  std::vector<HullShare> shares;
  shares.reserve(static_cast<std::size_t>(2 * std::ranges::count_if(piece_of, [&](auto n) { return wanted[n] != 0; })));
  for (std::uint32_t p = 0; p < patches.size(); ++p)
    for (const std::uint32_t side : {front_of(p), back_of(p)}) {
      if (wanted[piece_of[p]] == 0) continue;
      shares.push_back({piece_of[p], cells.find(side).set, side, {}});
      shares.back().sums.add(sums[p], side == front_of(p) ? -1 : 1);  // to look out of the cell
    }
  const std::vector<std::uint8_t> outside = find_outside(std::move(shares), patches.size());
  std::vector<PartSums> hull_sums(wanted.size());
  for (std::uint32_t p = 0; p < patches.size(); ++p) {
    const int orientation = int{outside[front_of(p)]} - int{outside[back_of(p)]};
    hull[p] = static_cast<std::int8_t>(orientation);
    if (orientation != 0) hull_sums[piece_of[p]].add(sums[p], orientation);
  }
  // Drop hulls that are no solid, or smaller than what they leave out.
  std::vector<double> most_left_out(wanted.size());
  for (std::uint32_t p = 0; p < patches.size(); ++p)
    if (hull[p] == 0 && is_solid(sums[p], false))
      most_left_out[piece_of[p]] = std::max(most_left_out[piece_of[p]], std::abs(sums[p].volume));
  for (std::uint32_t p = 0; p < patches.size(); ++p) {
    const PartSums& found = hull_sums[piece_of[p]];
    if (!is_solid(found, false) || found.volume < most_left_out[piece_of[p]]) hull[p] = 0;
  }
  return hull;
}

}  // namespace standoff
