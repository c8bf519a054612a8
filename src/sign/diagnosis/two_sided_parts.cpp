// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/two_sided_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/edge_sides.h"
#include "sign/diagnosis/patches.h"
#include "sign/diagnosis/pieces.h"
#include "sign/diagnosis/solid.h"

namespace standoff {
namespace {

// What closes the holes of a body is a smaller part of its area than that.
constexpr double kMostPartCaps = 1.0 / 3;

// The parts of which so many triangles are in pairs.
TwoSidedParts two_sided_candidates(const MeshEdges& edges, const Copies& copies, std::size_t triangles) {
  DisjointSets connected(edges.positions());
  for (std::size_t t = 0; t < triangles; ++t)
    for (const int corner : {1, 2}) connected.join(edges.position(t, 0), edges.position(t, corner));
  const auto set_of = [&](std::size_t t) { return connected.find(edges.position(t, 0)).set; };

  std::vector<std::uint32_t> count(edges.positions()), paired(edges.positions());
  for (std::size_t t = 0; t < triangles; ++t) {
    ++count[set_of(t)];
    paired[set_of(t)] += copies.paired[t];
  }
  TwoSidedParts parts;
  std::vector<std::uint32_t> number(edges.positions(), TwoSidedParts::kNone);
  for (std::size_t t = 0; t < triangles; ++t) {
    const std::uint32_t set = set_of(t);
    if (number[set] != TwoSidedParts::kNone || !(paired[set] >= kTwoSided * count[set])) continue;
    number[set] = static_cast<std::uint32_t>(parts.kept.size());
    parts.kept.push_back(1);
  }
  if (parts.size() == 0) return parts;
  parts.of.resize(triangles);
  for (std::size_t t = 0; t < triangles; ++t) parts.of[t] = number[set_of(t)];
  return parts;
}

// For each part the area of cones over its boundary, one for each loop, with its apex at the mean of the loop.
std::vector<double> caps_of_parts(MeshView mesh, const MeshEdges& edges, const TwoSidedParts& parts,
                                  const std::vector<std::int8_t>& turn) {
  struct Side {
    std::uint32_t position, part;
    Vec3 from, to;
  };
  struct Mean {
    Vec3 sum;
    double length = 0;
  };
  std::vector<Side> sides;
  DisjointSets connected(edges.positions());
  for_each_edge(edges, turn, [&](std::span<const EdgeUse> here) {
    const std::uint32_t part = parts.of[here.front().triangle];
    if (part == TwoSidedParts::kNone) return;
    int excess = 0;
    for (const EdgeUse& side : here) excess += side.forward ? turn[side.triangle] : -turn[side.triangle];
    if (excess == 0) return;
    const auto corners = mesh.corners(here.front().triangle);
    const std::size_t corner = here.front().corner;
    sides.push_back({here.front().low, part, corners[corner], corners[(corner + 1) % 3]});
    connected.join(here.front().low, here.front().high);
  });
  std::vector<Mean> means(sides.empty() ? 0 : edges.positions());
  for (const Side& side : sides) {
    Mean& mean = means[connected.find(side.position).set];
    const double long_ = length(side.to - side.from);
    mean.sum = mean.sum + (side.from + side.to) * (long_ / 2);
    mean.length += long_;
  }
  std::vector<double> caps(parts.size());
  for (const Side& side : sides) {
    const Mean& mean = means[connected.find(side.position).set];
    if (!(mean.length > 0)) continue;
    const Vec3 apex = mean.sum * (1 / mean.length);
    caps[side.part] += length(cross(side.from - apex, side.to - apex)) / 2;
  }
  return caps;
}

// The area of each part, and of its pieces that are solids.
struct PartAreas {
  double all = 0, solid = 0;
  bool unorientable = false;
};

std::vector<PartAreas> areas_of_parts(MeshView mesh, const TwoSidedParts& parts, const Patches& patches,
                                      const Pieces& pieces) {
  std::vector<PartSums> sums(pieces.size());
  std::vector<Box> boxes(pieces.size());
  const auto for_each = [&](const auto& use) {
    for (std::size_t t = 0; t < parts.of.size(); ++t)
      if (parts.of[t] != TwoSidedParts::kNone && patches.turn[t] != 0) use(t);
  };
  for_each([&](std::size_t t) {
    for (const Vec3& corner : mesh.corners(t)) boxes[pieces.of[t]].include(corner);
  });
  for_each([&](std::size_t t) {
    auto [a, b, c] = mesh.corners(t);
    if (patches.turn[t] < 0) std::swap(b, c);
    sums[pieces.of[t]].add(a, b, c, boxes[pieces.of[t]].center());
  });
  std::vector<PartAreas> areas(parts.size());
  for_each([&](std::size_t t) {
    const auto [a, b, c] = mesh.corners(t);
    const double area = length(cross(b - a, c - a)) / 2;
    const std::uint32_t piece = pieces.of[t];
    PartAreas& sum = areas[parts.of[t]];
    sum.all += area;
    sum.unorientable = sum.unorientable || pieces.unorientable[piece] != 0;
    if (is_solid(sums[piece], pieces.closed[piece] != 0)) sum.solid += area;
  });
  return areas;
}

}  // namespace

TwoSidedParts find_two_sided_parts(MeshView mesh, const MeshEdges& edges, const Copies& copies) {
  const std::size_t triangles = mesh.triangles.size();
  if (copies.opposite == 0 || copies.two_sided) return {};
  TwoSidedParts parts = two_sided_candidates(edges, copies, triangles);
  if (parts.size() == 0) return parts;
  Patches patches = find_patches(edges, find_copies(edges, triangles, parts), triangles);
  const Pieces pieces = find_pieces(mesh, edges, patches);
  const std::vector<PartAreas> areas = areas_of_parts(mesh, parts, patches, pieces);
  const std::vector<double> caps = caps_of_parts(mesh, edges, parts, patches.turn);
  for (std::size_t n = 0; n < parts.size(); ++n)
    parts.kept[n] =
        !areas[n].unorientable && areas[n].solid > areas[n].all / 2 && caps[n] < kMostPartCaps * areas[n].all;
  return parts;
}

}  // namespace standoff
