// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/copies.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <tuple>

#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/edge_sides.h"
#include "sign/diagnosis/two_sided_parts.h"

namespace standoff {
namespace {

// One triangle of a face with copies.
struct Copy {
  std::uint32_t third;  // the highest of the face's positions
  std::uint32_t triangle;
  bool forward;
};

// The faces with copies: face n has copies[begin[n]] to copies[begin[n + 1]], in the order of the triangles.
struct Faces {
  std::vector<Copy> copies;
  std::vector<std::size_t> begin = {0};

  std::size_t size() const { return begin.size() - 1; }
  std::span<const Copy> of(std::size_t face) const {
    return std::span(copies).subspan(begin[face], begin[face + 1] - begin[face]);
  }
};

// Each face is found at its edge between the two lower positions.
Faces faces_with_copies(const MeshEdges& edges) {
  Faces faces;
  std::vector<Copy> here;
  for_each_edge(edges, {}, [&](std::span<const EdgeUse> sides) {
    if (sides.size() == 1) return;
    here.clear();
    for (const EdgeUse& side : sides) {
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

// For each face with copies, how many more edges of its group speak for one copy than against it.
std::vector<std::int64_t> votes_for_one(const MeshEdges& edges, const Faces& faces, std::size_t triangles) {
  std::vector<std::uint32_t> face_of(triangles, kNoTriangle);
  for (std::size_t face = 0; face < faces.size(); ++face)
    for (const Copy& copy : faces.of(face)) face_of[copy.triangle] = static_cast<std::uint32_t>(face);
  DisjointSets groups(faces.size());
  std::vector<std::int64_t> votes(faces.size());
  std::vector<std::uint32_t> here;
  for_each_edge(edges, {}, [&](std::span<const EdgeUse> sides) {
    here.clear();
    for (const EdgeUse& side : sides) here.push_back(face_of[side.triangle]);
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

// The triangles in opposite pairs: of each face as many in either orientation.
void mark_paired(const Faces& faces, std::size_t triangles, Copies& found) {
  found.paired.assign(triangles, 0);
  for (std::size_t face = 0; face < faces.size(); ++face) {
    const std::span<const Copy> copies = faces.of(face);
    const auto forward = std::ranges::count_if(copies, &Copy::forward);
    std::array<std::int64_t, 2> left;
    left.fill(std::min(forward, std::ranges::ssize(copies) - forward));
    for (const Copy& copy : copies) found.paired[copy.triangle] = left[copy.forward]-- > 0;
  }
}

}  // namespace

Copies find_copies(const MeshEdges& edges, std::size_t triangles, const TwoSidedParts& parts) {
  Copies found;
  const Faces faces = faces_with_copies(edges);
  if (faces.size() == 0) return found;
  const auto forward_of = [&](std::size_t face) { return std::ranges::count_if(faces.of(face), &Copy::forward); };
  for (std::size_t face = 0; face < faces.size(); ++face) {
    const auto all = std::ranges::ssize(faces.of(face)), forward = forward_of(face), backward = all - forward;
    found.repeated += all - 1;
    found.opposite += std::min(forward, backward);
    found.same += std::max<std::int64_t>(forward - 1, 0) + std::max<std::int64_t>(backward - 1, 0);
  }
  if (found.opposite > 0) mark_paired(faces, triangles, found);
  found.two_sided = static_cast<double>(2 * found.opposite) >= kTwoSided * static_cast<double>(triangles);
  const std::vector<std::int64_t> votes = votes_for_one(edges, faces, triangles);
  found.use.assign(triangles, 1);
  for (std::size_t face = 0; face < faces.size(); ++face) {
    const std::span<const Copy> copies = faces.of(face);
    const auto forward = forward_of(face), backward = std::ranges::ssize(copies) - forward;
    const auto excess = std::abs(forward - backward);
    const bool one =
        votes[face] > 0 || (votes[face] == 0 && excess == 0) ||
        ((found.two_sided || parts.keeps(copies.front().triangle)) && excess != std::ranges::ssize(copies));
    const auto keep = one && excess % 2 == 0 ? std::int64_t{1} : excess;
    // Of the more frequent orientation; of the first triangle's if there are as many of both.
    const bool kept_forward = excess == 0 ? copies.front().forward : forward > backward;
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
    found.same_winding = found.same_winding && keep == excess;
    if (keep == 1 && opposite != kNoTriangle) found.either.emplace_back(kept, opposite);
  }
  if (found.left_out == 0) found.use.clear();
  return found;
}

}  // namespace standoff
