// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/duplicates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>

#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/diagnosis/patches.h"
#include "sign/oriented_mesh.h"

namespace standoff {

// Duplicates.

namespace {

// One triangle of a face with copies.
struct Copy {
  std::uint32_t third;  // the highest of the face's positions
  std::uint32_t triangle;
  bool forward;
};

// The faces with copies: face n has copies[begin[n]] to copies[begin[n + 1] - 1], in the order of the triangles.
struct Faces {
  std::vector<Copy> copies;
  std::vector<std::size_t> begin = {0};

  std::size_t size() const { return begin.size() - 1; }
  std::span<const Copy> of(std::size_t face) const {
    return std::span(copies).subspan(begin[face], begin[face + 1] - begin[face]);
  }
};

// Finds each face at its edge between the two lower positions.
Faces faces_with_copies(const MeshEdges& edges) {
  Faces faces;
  std::vector<Copy> here;
  for_each_edge(edges, {}, [&](std::span<const HalfEdge> sides) {
    if (sides.size() == 1) return;
    here.clear();
    for (const HalfEdge& side : sides) {
      const std::uint32_t third = edges.position(side.triangle, (side.corner + 2) % 3);
      if (third > side.high) here.push_back({third, side.triangle, side.forward});
    }
    if (here.size() < 2) return;
    std::ranges::sort(here, {}, [](const Copy& c) { return std::tuple(c.third, c.triangle); });
    for (auto next = here.begin(); next != here.end();) {
      const auto first = next;
      while (next != here.end() && next->third == first->third) ++next;
      if (next - first == 1) continue;
      faces.copies.insert(faces.copies.end(), first, next);
      faces.begin.push_back(faces.copies.size());
    }
  });
  return faces;
}

// For each face with copies: the votes of its group's edges for one copy, less the votes against it.
std::vector<std::int64_t> votes_for_one(const MeshEdges& edges, const Faces& faces, std::size_t triangles) {
  std::vector<std::uint32_t> face_of(triangles, kNoTriangle);
  for (std::size_t face = 0; face < faces.size(); ++face)
    for (const Copy& copy : faces.of(face)) face_of[copy.triangle] = static_cast<std::uint32_t>(face);
  DisjointSets groups(faces.size());
  std::vector<std::int64_t> votes(faces.size());
  std::vector<std::uint32_t> here;
  for_each_edge(edges, {}, [&](std::span<const HalfEdge> sides) {
    here.clear();
    for (const HalfEdge& side : sides) here.push_back(face_of[side.triangle]);
    const auto single = std::ranges::count(here, kNoTriangle);
    if (single == std::ranges::ssize(here)) return;
    std::ranges::sort(here);
    here.erase(std::unique(here.begin(), here.end()), here.end());
    if (single > 0) here.pop_back();
    if (single == 0 && here.size() == 2) {
      groups.join(here[0], here[1]);
      return;
    }
    const bool odd = (static_cast<std::size_t>(single) + here.size() - 1) % 2 == 1;
    for (const std::uint32_t face : here) votes[face] += odd ? 1 : -1;
  });
  std::vector<std::int64_t> sums(faces.size());
  for (std::size_t face = 0; face < faces.size(); ++face)
    sums[groups.find(static_cast<std::uint32_t>(face)).set] += votes[face];
  for (std::size_t face = 0; face < faces.size(); ++face)
    votes[face] = sums[groups.find(static_cast<std::uint32_t>(face)).set];
  return votes;
}

std::int64_t forward_in(std::span<const Copy> copies) { return std::ranges::count_if(copies, &Copy::forward); }

void count_copies(const Faces& faces, Duplicates& found) {
  for (std::size_t face = 0; face < faces.size(); ++face) {
    const std::span<const Copy> copies = faces.of(face);
    const std::int64_t all = std::ssize(copies), forward = forward_in(copies), backward = all - forward;
    found.repeated += all - 1;
    found.opposite += std::min(forward, backward);
    found.same += std::max<std::int64_t>(forward - 1, 0) + std::max<std::int64_t>(backward - 1, 0);
  }
}

// Marks the triangles in opposite pairs: the same number of each face in either orientation.
void mark_paired(const Faces& faces, std::size_t triangles, Duplicates& found) {
  found.paired.assign(triangles, 0);
  for (std::size_t face = 0; face < faces.size(); ++face) {
    const std::span<const Copy> copies = faces.of(face);
    const std::int64_t forward = forward_in(copies);
    std::array<std::int64_t, 2> left;
    left.fill(std::min(forward, std::ssize(copies) - forward));
    for (const Copy& copy : copies) found.paired[copy.triangle] = left[copy.forward]-- > 0;
  }
}

// Keeps `keep` copies of a face: of the more frequent orientation, or of the first triangle's if both are equally
// frequent. Leaves out the others.
void leave_out_copies(std::span<const Copy> copies, std::int64_t keep, Duplicates& found) {
  const std::int64_t forward = forward_in(copies), backward = std::ssize(copies) - forward;
  const bool kept_forward = forward == backward ? copies.front().forward : forward > backward;
  std::int64_t left = keep;
  std::uint32_t kept = kNoTriangle, opposite = kNoTriangle;
  for (const Copy& copy : copies) {
    if (copy.forward == kept_forward && left > 0) {
      --left;
      kept = copy.triangle;
      continue;
    }
    found.use[copy.triangle] = 0;
    ++found.left_out;
    if (copy.forward != kept_forward) opposite = copy.triangle;
  }
  found.same_winding = found.same_winding && keep == std::abs(forward - backward);
  if (keep == 1 && opposite != kNoTriangle) found.either.emplace_back(kept, opposite);
}

}  // namespace

Duplicates find_duplicates(const MeshEdges& edges, std::size_t triangles, const TwoSidedParts& parts) {
  Duplicates found;
  const Faces faces = faces_with_copies(edges);
  if (faces.size() == 0) return found;
  count_copies(faces, found);
  if (found.opposite > 0) mark_paired(faces, triangles, found);
  found.two_sided = static_cast<double>(2 * found.opposite) >= kTwoSided * static_cast<double>(triangles);

  const std::vector<std::int64_t> votes = votes_for_one(edges, faces, triangles);
  found.use.assign(triangles, 1);
  for (std::size_t face = 0; face < faces.size(); ++face) {
    const std::span<const Copy> copies = faces.of(face);
    const std::int64_t excess = std::abs(2 * forward_in(copies) - std::ssize(copies));
    const bool keeps_one = votes[face] > 0 || (votes[face] == 0 && excess == 0) ||
                           ((found.two_sided || parts.keeps(copies.front().triangle)) && excess != std::ssize(copies));
    leave_out_copies(copies, keeps_one && excess % 2 == 0 ? 1 : excess, found);
  }
  if (found.left_out == 0) found.use.clear();
  return found;
}

// Two-sided parts.

namespace {

// The caps that close the holes of a body are a smaller part of its area than this.
constexpr double kMostPartCaps = 1.0 / 3;

// The parts with enough triangles in pairs.
TwoSidedParts two_sided_candidates(const MeshEdges& edges, const Duplicates& duplicates, std::size_t triangles) {
  DisjointSets connected = edges.connected_positions();
  const auto set_of = [&](std::size_t t) { return connected.find(edges.position(t, 0)).set; };

  std::vector<std::uint32_t> count(edges.positions()), paired(edges.positions());
  for (std::size_t t = 0; t < triangles; ++t) {
    ++count[set_of(t)];
    paired[set_of(t)] += duplicates.paired[t];
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

// For each part the area of its caps: a cone over each boundary loop, with the apex at the mean of the loop.
std::vector<double> caps_of_parts(MeshView mesh, const MeshEdges& edges, const TwoSidedParts& parts,
                                  const std::vector<std::int8_t>& orientation) {
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
  for_each_edge(edges, orientation, [&](std::span<const HalfEdge> here) {
    const std::uint32_t part = parts.of[here.front().triangle];
    if (part == TwoSidedParts::kNone || excess_of(here, orientation) == 0) return;
    const auto corners = mesh.corners(here.front().triangle);
    const std::size_t corner = here.front().corner;
    sides.push_back({here.front().low, part, corners[corner], corners[(corner + 1) % 3]});
    connected.join(here.front().low, here.front().high);
  });
  std::vector<Mean> means(sides.empty() ? 0 : edges.positions());
  for (const Side& side : sides) {
    Mean& mean = means[connected.find(side.position).set];
    const double side_length = length(side.to - side.from);
    mean.sum = mean.sum + (side.from + side.to) * (side_length / 2);
    mean.length += side_length;
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

// The area of a part, and the area of its pieces that are solids.
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
      if (parts.of[t] != TwoSidedParts::kNone && patches.orientation[t] != 0) use(t);
  };
  for_each([&](std::size_t t) {
    for (const Vec3& corner : mesh.corners(t)) boxes[pieces.of[t]].include(corner);
  });
  for_each([&](std::size_t t) {
    const auto [a, b, c] = OrientedMesh{mesh, patches.orientation}.corners(t);
    sums[pieces.of[t]].add(a, b, c, boxes[pieces.of[t]].center());
  });
  std::vector<PartAreas> areas(parts.size());
  for_each([&](std::size_t t) {
    const double area = area_of(mesh.corners(t));
    const std::uint32_t piece = pieces.of[t];
    PartAreas& sum = areas[parts.of[t]];
    sum.all += area;
    sum.unorientable = sum.unorientable || pieces.unorientable[piece] != 0;
    if (is_solid(sums[piece], pieces.closed[piece] != 0)) sum.solid += area;
  });
  return areas;
}

}  // namespace

TwoSidedParts find_two_sided_parts(MeshView mesh, const MeshEdges& edges, const Duplicates& duplicates) {
  const std::size_t triangles = mesh.triangles.size();
  if (duplicates.opposite == 0 || duplicates.two_sided) return {};
  TwoSidedParts parts = two_sided_candidates(edges, duplicates, triangles);
  if (parts.size() == 0) return parts;
  Patches patches = find_patches(edges, find_duplicates(edges, triangles, parts), triangles);
  const Pieces pieces = find_pieces(mesh, edges, patches);
  const std::vector<PartAreas> areas = areas_of_parts(mesh, parts, patches, pieces);
  const std::vector<double> caps = caps_of_parts(mesh, edges, parts, patches.orientation);
  for (std::size_t n = 0; n < parts.size(); ++n)
    parts.kept[n] =
        !areas[n].unorientable && areas[n].solid > areas[n].all / 2 && caps[n] < kMostPartCaps * areas[n].all;
  return parts;
}

}  // namespace standoff
