// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/diagnosis_bytes.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "core/weld.h"
#include "sign/diagnosis/diagnose.h"
#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/duplicates.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/diagnosis/nesting.h"
#include "sign/oriented_mesh.h"

namespace standoff {

// What a mesh is built of.

namespace {

// Patches of fewer triangles are sheets, whatever their shape: a tetrahedron without a lid is flat enough for that.
constexpr std::uint32_t kFewestOfBody = 4;

class MeshCounter {
 public:
  MeshCounter(MeshView mesh, int threads)
      : mesh_(mesh), threads_(threads), number_(mesh.vertices.size()), patches_(mesh.triangles.size()) {
    found_.triangles = std::ssize(mesh.triangles);
    found_.vertices = std::ssize(mesh.vertices);
    found_.positions = weld([&](std::uint32_t v) { return mesh.vertices[v]; }, number_);
  }

  MeshCounts count() {
    constexpr std::int64_t kParts = 8;
    for (std::int64_t part = 0; part < kParts; ++part)
      count_edges_from(static_cast<std::uint32_t>(found_.positions * part / kParts),
                       static_cast<std::uint32_t>(found_.positions * (part + 1) / kParts));
    count_patches();
    // An open edge stays open unless its triangle is left out, as a copy or as a wall.
    const bool may_be_closed = found_.open == 0 || found_.sides > 0 || found_.copies > 0;
    if (may_be_closed) found_.winding_range = winding_range_bytes(mesh_, threads_);
    return found_;
  }

 private:
  struct SideOfFace {
    std::uint32_t third;  // the position that is not on the edge
    HalfEdge side;
  };

  std::array<std::uint32_t, 3> positions_of(std::size_t t) const {
    const Triangle corners = mesh_.triangles[t];
    return {number_[corners[0]], number_[corners[1]], number_[corners[2]]};
  }

  // The edges whose lower end is one of these positions. Triangles with two equal corners have none that count.
  void count_edges_from(std::uint32_t begin, std::uint32_t end) {
    const auto for_each_side = [&](const auto& use) {
      for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
        const auto p = positions_of(t);
        if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
        for (std::uint8_t n = 0; n < 3; ++n) {
          const std::uint32_t from = p[n], to = p[(n + 1) % 3], low = std::min(from, to);
          if (low >= begin && low < end)
            use(HalfEdge{low, std::max(from, to), static_cast<std::uint32_t>(t), n, from < to});
        }
      }
    };
    std::size_t count = 0;
    for_each_side([&](const HalfEdge&) { ++count; });
    std::vector<HalfEdge> sides;
    sides.reserve(count);
    for_each_side([&](const HalfEdge& side) { sides.push_back(side); });
    tbb::parallel_sort(sides.begin(), sides.end(), [](const HalfEdge& a, const HalfEdge& b) {
      return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    for (auto next = sides.begin(); next != sides.end();) {
      const auto first = next;
      while (next != sides.end() && next->low == first->low && next->high == first->high) ++next;
      count_edge({first, next});
    }
  }

  // Pairs of copies in opposite orientation count as one triangle: two neighbours in pairs lose one of each, or both
  // (find_duplicates()). What becomes of other copies is not known, so all sides of their edges count.
  void count_edge(std::span<const HalfEdge> sides) {
    if (sides.size() > 1) sides = without_pairs(sides);
    const std::int64_t size = std::ssize(sides);
    if (size == 1) {
      ++found_.open;
    } else if (size > 2) {
      found_.sides += size;
    } else {
      const bool flipped = sides[0].forward == sides[1].forward;
      found_.inconsistent += flipped;
      found_.orientable &= patches_.join(sides[0].triangle, sides[1].triangle, flipped);
    }
  }

  // The first side of each pair if the edge has nothing but pairs, of two faces or one; else all sides. Counts each
  // triangle with copies once, at the edge of its two lower positions.
  std::span<const HalfEdge> without_pairs(std::span<const HalfEdge> sides) {
    by_face_.clear();
    for (const HalfEdge& side : sides) by_face_.push_back({positions_of(side.triangle)[(side.corner + 2U) % 3], side});
    std::ranges::sort(by_face_, {}, [](const SideOfFace& one) { return std::tuple(one.third, one.side.triangle); });
    firsts_.clear();
    bool all_pairs = true;
    for (auto next = by_face_.begin(); next != by_face_.end();) {
      const auto first = next;
      while (next != by_face_.end() && next->third == first->third) ++next;
      const bool is_pair = next - first == 2 && first->side.forward != first[1].side.forward;
      all_pairs &= is_pair;
      if (next - first > 1 && first->third > first->side.high) {
        found_.copies += next - first;
        found_.opposite += is_pair;
      }
      firsts_.push_back(first->side);
    }
    return all_pairs && firsts_.size() <= 2 ? firsts_ : sides;
  }

  void count_patches() {
    std::vector<std::uint32_t> size(mesh_.triangles.size());
    for (std::uint32_t t = 0; t < size.size(); ++t) ++size[patches_.find(t).set];
    for (const std::uint32_t triangles : size) {
      found_.patches += triangles > 0;
      found_.bodies += triangles >= kFewestOfBody;
    }
  }

  MeshView mesh_;
  int threads_;
  std::vector<std::uint32_t> number_;  // of the position of each vertex
  DisjointSets patches_;
  std::vector<SideOfFace> by_face_;
  std::vector<HalfEdge> firsts_;
  MeshCounts found_;
};

}  // namespace

std::int64_t MeshCounts::most_boundary(bool as_oriented) const {
  const bool stays_inconsistent = as_oriented || !orientable;
  return std::min(3 * triangles, open + sides + (stays_inconsistent ? 2 * inconsistent : 0));
}

MeshCounts count_mesh(MeshView mesh, int threads) { return MeshCounter(mesh, threads).count(); }

MeshCounts most_counts(std::int64_t triangles, int threads) {
  return {.triangles = triangles,
          .vertices = 3 * triangles,
          .positions = 3 * triangles,
          .patches = triangles,
          .bodies = triangles / kFewestOfBody,
          .open = 2 * triangles,
          .sides = 3 * triangles,
          .inconsistent = 3 * triangles / 2,
          .copies = triangles,
          .orientable = false,
          .winding_range = winding_range_bytes(triangles, threads)};
}

// The memory of each step, in bytes. A vector that grows is held twice, and half as large: three times its content.

namespace {

constexpr std::int64_t kGrowth = 3;

// MeshEdges, when it is made.
std::int64_t edges_bytes(const MeshCounts& m) {
  return m.triangles * (3 * sizeof(std::uint32_t) + 3 * sizeof(HalfEdge)) + (m.positions + 1) * sizeof(std::size_t);
}
// While it is made: the position of each vertex, and a place for each position.
std::int64_t making_edges_bytes(const MeshCounts& m) {
  constexpr std::int64_t kWeld = 12;
  const std::int64_t numbers = sizeof(std::uint32_t) * m.vertices;
  return numbers + std::max(kWeld * m.vertices, edges_bytes(m) + 8 * m.positions);
}

// Then one of each pair is kept, and nothing else is looked for.
bool is_two_sided(const MeshCounts& m) {
  return static_cast<double>(2 * m.opposite) >= kTwoSided * static_cast<double>(m.triangles);
}

// What remains of find_duplicates(): two marks for each triangle, and a pair for each second copy. It may run twice,
// and the part of each triangle is known then.
std::int64_t duplicates_bytes(const MeshCounts& m) {
  const std::int64_t once = m.copies > 0 ? 2 * m.triangles + 8 * m.copies : 0;
  return m.copies == 0 || is_two_sided(m) ? once : 2 * once + 4 * m.triangles;
}
// While it runs: faces, their votes, the face of each triangle.
std::int64_t finding_duplicates_bytes(const MeshCounts& m) {
  return m.copies > 0 ? duplicates_bytes(m) + 6 * m.triangles + (kGrowth * 12 + 36) * m.copies : 0;
}

// find_patches(), and what it leaves. Copies that are left out become patches of their own; of two, one was that
// before.
std::int64_t most_patches(const MeshCounts& m) {
  return std::min(m.triangles, m.patches + m.copies / 2 - (is_two_sided(m) ? m.opposite : 0));
}
std::int64_t finding_patches_bytes(const MeshCounts& m) {
  const bool may_contradict = !m.orientable || m.copies > 0;
  return 13 * m.triangles + (8 * kGrowth + 1) * most_patches(m) + (may_contradict ? 18 * m.triangles : 0);
}
std::int64_t patches_bytes(const MeshCounts& m) { return 5 * m.triangles + most_patches(m); }

// find_pieces(): the piece of each triangle; of each patch its numbers and orientations; where patches meet also the
// outer hull of each, and of each side its borders and the pairs of patches, which are taken greedily. Edges of eight
// sides have the most pairs of patches for each side (pairs_of()): 28.
std::int64_t finding_pieces_bytes(const MeshCounts& m) {
  constexpr std::int64_t kOfPatch = 64, kOfHull = 128 + 5 * sizeof(PartSums), kOfBorder = 11, kOfPair = 16 + 48;
  const std::int64_t meeting = m.sides > 0 ? kOfHull * most_patches(m) + (kOfBorder + kOfPair * 28 / 8) * m.sides : 0;
  return patches_bytes(m) + 4 * m.triangles + kOfPatch * most_patches(m) + meeting;
}

// orient_outwards(): the sizes of pieces; if some may be inside others also what find_nesting() takes.
std::int64_t orienting_outwards_bytes(const MeshCounts& m) {
  const std::int64_t pieces = most_patches(m);
  const std::int64_t sizes =
      9 * m.triangles + static_cast<std::int64_t>(8 + 2 * sizeof(Part) + sizeof(PartSums)) * pieces;
  // Patches that meet may be one body.
  const std::int64_t bodies = m.bodies + std::min(pieces, m.sides);
  if (bodies < 2) return sizes;
  constexpr std::int64_t kOfBody = 400;
  const std::int64_t crossings = 16 * m.triangles;
  return sizes + 4 * m.triangles + 8 * pieces + crossings + kOfBody * bodies;
}

// Parts that are there in both orientations, while their patches and pieces are known.
std::int64_t two_sided_bytes(const MeshCounts& m, std::int64_t boundary) {
  if (m.copies == 0 || is_two_sided(m)) return 0;
  return patches_bytes(m) + 4 * m.triangles + 8 * most_patches(m) +
         std::max(static_cast<std::int64_t>(sizeof(Box) + sizeof(PartSums)) * most_patches(m),
                  kGrowth * 56 * boundary + 40 * m.positions);
}

// After the orientation: the boundary and its polygons, and cracks.
std::int64_t boundary_bytes(std::int64_t boundary) { return (140 + kBoundaryEdgeBytes) * boundary; }
std::int64_t cracks_bytes(const MeshCounts& m, std::int64_t boundary) {
  const std::int64_t edges = m.open + m.sides / 3, points = std::min(2 * edges, m.positions);
  return kBoundaryEdgeBytes * boundary + 4 * m.positions + 12 * edges + 32 * points +
         std::max(76 * points, 12 * m.triangles);
}

}  // namespace

std::int64_t diagnosis_bytes(const MeshCounts& m, bool as_oriented) {
  const std::int64_t boundary = m.most_boundary(as_oriented), duplicates = duplicates_bytes(m);
  const std::int64_t orienting = std::max(
      {finding_duplicates_bytes(m), duplicates + finding_patches_bytes(m), duplicates + finding_pieces_bytes(m),
       duplicates + orienting_outwards_bytes(m), duplicates + two_sided_bytes(m, boundary)});
  const std::int64_t after =
      m.triangles + std::max({boundary_bytes(boundary), m.winding_range, cracks_bytes(m, boundary)});
  return std::max(making_edges_bytes(m), edges_bytes(m) + std::max(orienting, after));
}

}  // namespace standoff
