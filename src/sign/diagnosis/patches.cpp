// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/patches.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <queue>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/oriented_mesh.h"

namespace standoff {

Patches find_patches(const MeshEdges& edges, const Duplicates& duplicates, std::size_t triangles) {
  DisjointSets sets(triangles);
  std::vector<std::uint32_t> contradictions;
  for_each_edge(edges, duplicates.use, [&](std::span<const HalfEdge> sides) {
    if (!is_manifold(sides)) return;
    const bool flipped = sides[0].forward == sides[1].forward;
    if (!sets.join(sides[0].triangle, sides[1].triangle, flipped)) contradictions.push_back(sides[0].triangle);
  });

  Patches found;
  found.of.resize(triangles);
  found.orientation.resize(triangles);
  std::vector<std::int64_t> balance;  // of each patch: its triangles as the first one, less those flipped against it
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const auto [first, flipped] = sets.find(t);
    if (first == t) {
      found.of[t] = static_cast<std::uint32_t>(balance.size());
      balance.push_back(0);
    }
    found.of[t] = found.of[first];
    found.orientation[t] = flipped ? -1 : 1;
    balance[found.of[t]] += found.orientation[t];
  }
  for (const auto& [kept, opposite] : duplicates.either) balance[found.of[kept]] -= found.orientation[kept];
  found.unorientable.resize(balance.size());
  for (const std::uint32_t t : contradictions) found.unorientable[found.of[t]] = 1;
  for (std::size_t t = 0; t < triangles; ++t) {
    if (found.unorientable[found.of[t]] != 0)
      found.orientation[t] = 1;
    else if (balance[found.of[t]] < 0)
      found.orientation[t] = static_cast<std::int8_t>(-found.orientation[t]);
    if (!duplicates.use.empty() && duplicates.use[t] == 0) found.orientation[t] = 0;
  }
  return found;
}

std::int64_t inconsistent_edges(const MeshEdges& edges, std::span<const std::int8_t> use) {
  std::int64_t count = 0;
  for_each_edge(edges, use, [&](std::span<const HalfEdge> sides) {
    if (!is_manifold(sides)) return;
    const auto forward = [&](const HalfEdge& side) { return side.forward == (use.empty() || use[side.triangle] > 0); };
    count += forward(sides[0]) == forward(sides[1]);
  });
  return count;
}

namespace {

// Two patches with a common border. They gain if both are flipped or neither is, and lose the same if one is.
struct PatchPair {
  std::uint32_t a, b;
  std::int64_t gain;
};

struct Preference {
  std::uint32_t other;
  std::int64_t gain;
};

// The orientation of each patch, 1 or -1, so that the sum of all gains is large. To find the largest sum is a hard
// problem (a maximum cut). This orients one patch after the other: always the one whose preferences toward the patches
// oriented before have the largest sum, the first one if there are several. It is flipped if that sum is negative.
// Takes the time of sorting the pairs.
std::vector<std::int8_t> greedy_orientations(std::size_t count, std::span<const PatchPair> pairs) {
  std::vector<std::size_t> begin(count + 1);
  for (const PatchPair& pair : pairs) ++begin[pair.a + 1], ++begin[pair.b + 1];
  for (std::size_t n = 0; n < count; ++n) begin[n + 1] += begin[n];
  std::vector<Preference> preferences(begin[count]);
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (const PatchPair& pair : pairs) {
    preferences[next[pair.a]++] = {pair.b, pair.gain};
    preferences[next[pair.b]++] = {pair.a, pair.gain};
  }

  // Take the strongest sum first, then the least number. A sum that has changed meanwhile is in the queue again: each
  // pair changes one.
  using Entry = std::pair<std::int64_t, std::int64_t>;
  std::vector<Entry> entries;
  entries.reserve(pairs.size() + 1);
  std::priority_queue<Entry> queue(std::less<Entry>(), std::move(entries));
  std::vector<std::int8_t> orientations(count, 1);
  std::vector<std::uint8_t> done(count);
  std::vector<std::int64_t> sums(count);
  for (std::uint32_t first = 0; first < count; ++first) {
    if (done[first] != 0 || begin[first] == begin[first + 1]) continue;
    queue.emplace(0, -std::int64_t{first});
    while (!queue.empty()) {
      const auto [strength, number] = queue.top();
      queue.pop();
      const auto n = static_cast<std::uint32_t>(-number);
      if (done[n] != 0 || strength != std::abs(sums[n])) continue;
      done[n] = 1;
      if (sums[n] < 0) orientations[n] = -1;
      for (std::size_t w = begin[n]; w < begin[n + 1]; ++w) {
        const auto [other, gain] = preferences[w];
        if (done[other] != 0) continue;
        sums[other] += orientations[n] * gain;
        queue.emplace(std::abs(sums[other]), -std::int64_t{other});
      }
    }
  }
  return orientations;
}

// A patch, or a piece, at an edge where its half-edges do not cancel each other.
struct Border {
  std::uint32_t patch;
  std::int32_t excess;  // half-edges from the lower position to the higher one, less those that go back
};

// The borders at an edge, by patch. `patch_of`: the patch, or piece, of each triangle.
void find_borders_at(std::span<const HalfEdge> sides, const std::vector<std::uint32_t>& patch_of,
                     std::span<const std::int8_t> orientation, std::vector<Border>& here) {
  here.clear();
  for (const HalfEdge& side : sides) here.push_back({patch_of[side.triangle], direction_of(side, orientation)});
  if (here.size() == 2 && here[0].patch == here[1].patch && here[0].excess == -here[1].excess) return here.clear();
  std::ranges::sort(here, {}, &Border::patch);
  std::size_t borders = 0;
  for (std::size_t next = 0; next < here.size();) {
    Border sum{here[next].patch, 0};
    for (; next < here.size() && here[next].patch == sum.patch; ++next) sum.excess += here[next].excess;
    if (sum.excess != 0) here[borders++] = sum;
  }
  here.resize(borders);
}

// The borders at all nonmanifold edges: edge n has all[begin[n]] to all[begin[n + 1] - 1].
struct Borders {
  std::vector<Border> all;
  std::vector<std::size_t> begin = {0};

  template <class Use>
  void for_each(const Use& use) const {
    for (std::size_t n = 0; n + 1 < begin.size(); ++n) use(std::span(all).subspan(begin[n], begin[n + 1] - begin[n]));
  }
};

Borders find_borders(const MeshEdges& edges, const Patches& patches) {
  const auto for_each_nonmanifold = [&](const auto& use) {
    for_each_edge(edges, patches.orientation, [&](std::span<const HalfEdge> sides) {
      if (sides.size() > 2) use(sides);
    });
  };
  std::size_t count = 0, sides_of_all = 0;
  for_each_nonmanifold([&](std::span<const HalfEdge> sides) {
    ++count;
    sides_of_all += sides.size();
  });
  Borders borders;
  if (count == 0) return borders;
  borders.all.reserve(sides_of_all);
  borders.begin.reserve(count + 1);
  std::vector<Border> here;
  for_each_nonmanifold([&](std::span<const HalfEdge> sides) {
    find_borders_at(sides, patches.of, patches.orientation, here);
    borders.all.insert(borders.all.end(), here.begin(), here.end());
    if (!here.empty()) borders.begin.push_back(borders.all.size());
  });
  return borders;
}

// The pairs of patches with a common border. They gain if most of it cancels in their present orientation. At an edge
// with many patches only neighbours in the list become pairs, because all pairs could be the square of the triangles.
std::vector<PatchPair> pairs_of(const Borders& borders) {
  constexpr std::size_t kMany = 8;
  const auto for_each_pair = [&](const auto& use) {
    borders.for_each([&](std::span<const Border> here) {
      for (std::size_t i = 0; i < here.size(); ++i)
        for (std::size_t j = i + 1; j < (here.size() > kMany ? std::min(i + 2, here.size()) : here.size()); ++j)
          use(here[i], here[j]);
    });
  };
  std::size_t count = 0;
  for_each_pair([&](const Border&, const Border&) { ++count; });
  std::vector<PatchPair> pairs;
  pairs.reserve(count);
  for_each_pair([&](const Border& a, const Border& b) {
    pairs.push_back({a.patch, b.patch, -std::int64_t{a.excess} * b.excess});
  });
  std::ranges::sort(pairs, {}, [](const PatchPair& p) { return std::tuple(p.a, p.b); });
  std::size_t sums = 0;
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    if (sums > 0 && pairs[sums - 1].a == pairs[n].a && pairs[sums - 1].b == pairs[n].b)
      pairs[sums - 1].gain += pairs[n].gain;
    else
      pairs[sums++] = pairs[n];
  }
  pairs.resize(sums);
  return pairs;
}

void mark_open(const MeshEdges& edges, const Patches& patches, Pieces& pieces) {
  std::vector<Border> here;
  for_each_edge(edges, patches.orientation, [&](std::span<const HalfEdge> sides) {
    find_borders_at(sides, pieces.of, patches.orientation, here);
    for (const Border& border : here) pieces.closed[border.patch] = 0;
  });
}

// The pieces, all taken to be closed for now, and the piece of each patch.
Pieces join_patches(const Patches& patches, const std::vector<PatchPair>& pairs, std::vector<std::uint32_t>& piece_of) {
  DisjointSets sets(patches.size());
  for (const PatchPair& pair : pairs) sets.join(pair.a, pair.b);
  Pieces found;
  piece_of.resize(patches.size());
  for (std::uint32_t p = 0; p < patches.size(); ++p) {
    const std::uint32_t first = sets.find(p).set;
    if (first == p) {
      piece_of[p] = static_cast<std::uint32_t>(found.unorientable.size());
      found.unorientable.push_back(0);
    }
    piece_of[p] = piece_of[first];
    found.unorientable[piece_of[p]] |= patches.unorientable[p];
  }
  found.closed.assign(found.unorientable.size(), 1);
  found.of.reserve(patches.of.size());
  for (const std::uint32_t patch : patches.of) found.of.push_back(piece_of[patch]);
  return found;
}

// The excess that is left over at the borders of each piece in these orientations.
std::vector<std::int64_t> weights(const Borders& borders, const std::vector<std::uint32_t>& piece_of,
                                  std::size_t pieces, const std::vector<std::int8_t>& orientations) {
  std::vector<std::int64_t> sums(pieces);
  borders.for_each([&](std::span<const Border> here) {
    std::int64_t sum = 0;
    for (const Border& border : here) sum += orientations[border.patch] * border.excess;
    sums[piece_of[here.front().patch]] += std::abs(sum);
  });
  return sums;
}

// Reverses all orientations in the pieces of which more triangles would be flipped than not.
void let_majority_stay(const Patches& patches, const std::vector<std::uint32_t>& piece_of, std::size_t pieces,
                       std::vector<std::int8_t>& orientations) {
  std::vector<std::int64_t> balance(pieces);
  for (const std::uint32_t patch : patches.of) balance[piece_of[patch]] += orientations[patch];
  for (std::size_t p = 0; p < orientations.size(); ++p)
    if (balance[piece_of[p]] < 0) orientations[p] = static_cast<std::int8_t>(-orientations[p]);
}

// The orientations after patches of the wanted pieces are left out where that leaves less over, those with few
// triangles first.
std::vector<std::int8_t> leave_out_greedily(const Borders& borders, const Patches& patches,
                                            const std::vector<std::uint32_t>& piece_of,
                                            const std::vector<std::uint8_t>& wanted,
                                            std::vector<std::int8_t> orientations) {
  std::vector<std::int64_t> triangles(patches.size());
  for (const std::uint32_t patch : patches.of) ++triangles[patch];
  struct EdgeExcess {
    std::size_t edge;
    std::int64_t excess;
  };
  std::vector<std::vector<EdgeExcess>> borders_of(patches.size());
  std::vector<std::int64_t> left_over;
  borders.for_each([&](std::span<const Border> here) {
    const std::size_t edge = left_over.size();
    left_over.push_back(0);
    if (wanted[piece_of[here.front().patch]] == 0) return;
    for (const Border& border : here) {
      borders_of[border.patch].push_back({edge, border.excess});
      left_over.back() += orientations[border.patch] * border.excess;
    }
  });

  std::vector<std::uint32_t> order;
  for (std::uint32_t p = 0; p < patches.size(); ++p)
    if (!borders_of[p].empty()) order.push_back(p);
  std::ranges::sort(order, {}, [&](std::uint32_t p) { return std::tuple(triangles[p], p); });
  for (const std::uint32_t p : order) {
    std::int64_t gain = 0;
    for (const EdgeExcess& at : borders_of[p])
      gain += std::abs(left_over[at.edge]) - std::abs(left_over[at.edge] - orientations[p] * at.excess);
    if (gain <= 0) continue;
    for (const EdgeExcess& at : borders_of[p]) left_over[at.edge] -= orientations[p] * at.excess;
    orientations[p] = 0;
  }
  return orientations;
}

// Leaves patches of the wanted pieces out that do not cancel, in pieces in which all cancels then, and the majority
// stays a solid.
void leave_out_what_does_not_cancel(MeshView mesh, const Borders& borders, const Patches& patches,
                                    const std::vector<std::uint32_t>& piece_of, const std::vector<std::uint8_t>& wanted,
                                    std::vector<std::int8_t>& orientations) {
  const std::vector<std::int8_t> found = leave_out_greedily(borders, patches, piece_of, wanted, orientations);
  const std::size_t pieces = wanted.size();
  const std::vector<std::int64_t> weight = weights(borders, piece_of, pieces, found);
  std::vector<std::int64_t> balance(pieces);
  std::vector<PartSums> sums(pieces);
  std::vector<Box> boxes(pieces);
  const auto for_each_used = [&](const auto& use) {
    for (std::size_t t = 0; t < patches.of.size(); ++t) {
      const std::uint32_t patch = patches.of[t], piece = piece_of[patch];
      if (wanted[piece] != 0) use(piece, found[patch] * patches.orientation[t], mesh.corners(t));
    }
  };
  for_each_used([&](std::uint32_t piece, int, const auto& corners) {
    for (const Vec3& corner : corners) boxes[piece].include(corner);
  });
  for_each_used([&](std::uint32_t piece, int orientation, const auto& corners) {
    balance[piece] += orientation != 0 ? 1 : -1;
    if (orientation == 0) return;
    const bool as_it_is = orientation > 0;
    sums[piece].add(corners[0], corners[as_it_is ? 1 : 2], corners[as_it_is ? 2 : 1], boxes[piece].center());
  });
  for (std::uint32_t p = 0; p < patches.size(); ++p) {
    const std::uint32_t piece = piece_of[p];
    if (wanted[piece] != 0 && weight[piece] == 0 && balance[piece] > 0 && is_solid(sums[piece], false))
      orientations[p] = found[p];
  }
}

}  // namespace

Pieces find_pieces(MeshView mesh, const MeshEdges& edges, Patches& patches) {
  const Borders borders = find_borders(edges, patches);
  const std::vector<PatchPair> pairs = pairs_of(borders);
  std::vector<std::uint32_t> piece_of;
  Pieces found = join_patches(patches, pairs, piece_of);
  const auto weights_of = [&](const std::vector<std::int8_t>& orientations) {
    return weights(borders, piece_of, found.size(), orientations);
  };

  // Orient greedily.
  std::vector<std::int8_t> orientations = greedy_orientations(patches.size(), pairs);
  const std::vector<std::int64_t> as_is = weights_of(std::vector<std::int8_t>(patches.size(), 1)),
                                  greedy = weights_of(orientations);
  let_majority_stay(patches, piece_of, found.size(), orientations);

  // Prefer the outer hull where something is left over.
  std::vector<std::uint8_t> left_over(found.size());
  for (std::size_t n = 0; n < found.size(); ++n) left_over[n] = found.unorientable[n] == 0 && as_is[n] > 0;
  const std::vector<std::int8_t> hull = outer_hulls(mesh, edges, patches, piece_of, left_over);
  const std::vector<std::int64_t> of_hull = weights_of(hull);
  std::vector<std::uint8_t> has_hull(found.size());
  for (std::size_t p = 0; p < hull.size(); ++p) has_hull[piece_of[p]] |= hull[p] != 0 && of_hull[piece_of[p]] == 0;

  for (std::size_t p = 0; p < orientations.size(); ++p) {
    const std::uint32_t piece = piece_of[p];
    if (has_hull[piece] != 0) {
      orientations[p] = hull[p];
    } else if (found.unorientable[piece] != 0 || as_is[piece] <= greedy[piece]) {
      orientations[p] = 1;
    }
  }

  // Leave out what does not cancel even so.
  std::vector<std::uint8_t> uncancelled(found.size());
  const std::vector<std::int64_t> chosen = weights_of(orientations);
  for (std::size_t n = 0; n < found.size(); ++n)
    uncancelled[n] = left_over[n] != 0 && has_hull[n] == 0 && chosen[n] > 0;
  if (std::ranges::count(uncancelled, 0) != std::ssize(uncancelled))
    leave_out_what_does_not_cancel(mesh, borders, patches, piece_of, uncancelled, orientations);

  // Apply the orientations to the triangles.
  for (std::size_t t = 0; t < patches.orientation.size(); ++t) {
    const int orientation = orientations[patches.of[t]];
    found.walls += orientation == 0 && patches.orientation[t] != 0;
    patches.orientation[t] = static_cast<std::int8_t>(orientation * patches.orientation[t]);
  }
  mark_open(edges, patches, found);
  return found;
}

}  // namespace standoff
