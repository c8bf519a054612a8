// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/pieces.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/edge_sides.h"
#include "sign/diagnosis/greedy_turns.h"
#include "sign/diagnosis/outer_hull.h"
#include "sign/diagnosis/solid.h"

namespace standoff {
namespace {

// A patch at a nonmanifold edge where its sides do not cancel each other.
struct Border {
  std::uint32_t patch;
  std::int32_t excess;  // of sides from the lower position to the higher one
};

// The borders at all nonmanifold edges: edge n has all[begin[n]] to all[begin[n + 1]].
struct Borders {
  std::vector<Border> all;
  std::vector<std::size_t> begin = {0};

  template <class Use>
  void for_each_edge(const Use& use) const {
    for (std::size_t n = 0; n + 1 < begin.size(); ++n) use(std::span(all).subspan(begin[n], begin[n + 1] - begin[n]));
  }
};

Borders find_borders(const MeshEdges& edges, const Patches& patches) {
  Borders borders;
  std::vector<Border> here;
  for_each_edge(edges, patches.turn, [&](std::span<const EdgeUse> sides) {
    if (sides.size() < 3) return;
    here.clear();
    for (const EdgeUse& side : sides)
      here.push_back(
          {patches.of[side.triangle], side.forward ? patches.turn[side.triangle] : -patches.turn[side.triangle]});
    std::ranges::sort(here, {}, &Border::patch);
    for (auto next = here.begin(); next != here.end();) {
      Border sum{next->patch, 0};
      for (; next != here.end() && next->patch == sum.patch; ++next) sum.excess += next->excess;
      if (sum.excess != 0) borders.all.push_back(sum);
    }
    if (borders.all.size() > borders.begin.back()) borders.begin.push_back(borders.all.size());
  });
  return borders;
}

// The pairs of patches with a common border; gain > 0: most of it cancels as they are. At an edge with many patches
// only neighbours in the list are paired: all pairs could be the square of the triangles.
std::vector<TurnPair> pairs_of(const Borders& borders) {
  constexpr std::size_t kMany = 8;
  std::vector<TurnPair> pairs;
  borders.for_each_edge([&](std::span<const Border> here) {
    for (std::size_t i = 0; i < here.size(); ++i)
      for (std::size_t j = i + 1; j < (here.size() > kMany ? std::min(i + 2, here.size()) : here.size()); ++j)
        pairs.push_back({here[i].patch, here[j].patch, -std::int64_t{here[i].excess} * here[j].excess});
  });
  std::ranges::sort(pairs, {}, [](const TurnPair& p) { return std::tuple(p.a, p.b); });
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
  for_each_edge(edges, patches.turn, [&](std::span<const EdgeUse> sides) {
    here.clear();
    for (const EdgeUse& side : sides)
      here.push_back(
          {pieces.of[side.triangle], side.forward ? patches.turn[side.triangle] : -patches.turn[side.triangle]});
    if (here.size() == 2 && here[0].patch == here[1].patch && here[0].excess == -here[1].excess) return;
    std::ranges::sort(here, {}, &Border::patch);
    for (auto next = here.begin(); next != here.end();) {
      Border sum{next->patch, 0};
      for (; next != here.end() && next->patch == sum.patch; ++next) sum.excess += next->excess;
      if (sum.excess != 0) pieces.closed[sum.patch] = 0;
    }
  });
}

// The pieces, all taken to be closed, and the piece of each patch.
Pieces join_patches(const Patches& patches, const std::vector<TurnPair>& pairs, std::vector<std::uint32_t>& piece_of) {
  DisjointSets sets(patches.size());
  for (const TurnPair& pair : pairs) sets.join(pair.a, pair.b);
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
  for (const std::uint32_t patch : patches.of) found.of.push_back(piece_of[patch]);
  return found;
}

// What the borders of each piece weigh if its patches are turned so.
std::vector<std::int64_t> weights(const Borders& borders, const std::vector<std::uint32_t>& piece_of,
                                  std::size_t pieces, const std::vector<std::int8_t>& turns) {
  std::vector<std::int64_t> sums(pieces);
  borders.for_each_edge([&](std::span<const Border> here) {
    std::int64_t sum = 0;
    for (const Border& border : here) sum += turns[border.patch] * border.excess;
    sums[piece_of[here.front().patch]] += std::abs(sum);
  });
  return sums;
}

// Makes -1 of 1 and 1 of -1 in the pieces of which more triangles would be turned than not.
void let_majority_stay(const Patches& patches, const std::vector<std::uint32_t>& piece_of, std::size_t pieces,
                       std::vector<std::int8_t>& turns) {
  std::vector<std::int64_t> balance(pieces);
  for (const std::uint32_t patch : patches.of) balance[piece_of[patch]] += turns[patch];
  for (std::size_t p = 0; p < turns.size(); ++p)
    if (balance[piece_of[p]] < 0) turns[p] = static_cast<std::int8_t>(-turns[p]);
}

// Leaves patches out, those with few triangles first, where that makes less to be left over: of the pieces that are
// `wanted`. Keeps it for those in which all cancels then, and the majority stays a solid.
void leave_out_what_does_not_cancel(MeshView mesh, const Borders& borders, const Patches& patches,
                                    const std::vector<std::uint32_t>& piece_of, const std::vector<std::uint8_t>& wanted,
                                    std::vector<std::int8_t>& turns) {
  std::vector<std::int64_t> triangles(patches.size());
  for (const std::uint32_t patch : patches.of) ++triangles[patch];
  struct At {
    std::size_t edge;
    std::int64_t excess;
  };
  std::vector<std::vector<At>> borders_of(patches.size());
  std::vector<std::int64_t> left_over;
  borders.for_each_edge([&](std::span<const Border> here) {
    const std::size_t edge = left_over.size();
    left_over.push_back(0);
    if (wanted[piece_of[here.front().patch]] == 0) return;
    for (const Border& border : here) {
      borders_of[border.patch].push_back({edge, border.excess});
      left_over.back() += turns[border.patch] * border.excess;
    }
  });
  std::vector<std::uint32_t> order;
  for (std::uint32_t p = 0; p < patches.size(); ++p)
    if (!borders_of[p].empty()) order.push_back(p);
  std::ranges::sort(order, {}, [&](std::uint32_t p) { return std::tuple(triangles[p], p); });
  std::vector<std::int8_t> found = turns;
  for (const std::uint32_t p : order) {
    std::int64_t gain = 0;
    for (const At& at : borders_of[p])
      gain += std::abs(left_over[at.edge]) - std::abs(left_over[at.edge] - found[p] * at.excess);
    if (gain <= 0) continue;
    for (const At& at : borders_of[p]) left_over[at.edge] -= found[p] * at.excess;
    found[p] = 0;
  }

  const std::size_t pieces = wanted.size();
  const std::vector<std::int64_t> weight = weights(borders, piece_of, pieces, found);
  std::vector<std::int64_t> balance(pieces);
  std::vector<PartSums> sums(pieces);
  std::vector<Box> boxes(pieces);
  const auto for_each_used = [&](const auto& use) {
    for (std::size_t t = 0; t < patches.of.size(); ++t) {
      const std::uint32_t patch = patches.of[t], piece = piece_of[patch];
      if (wanted[piece] != 0) use(piece, found[patch] * patches.turn[t], mesh.corners(t));
    }
  };
  for_each_used([&](std::uint32_t piece, int, const auto& corners) {
    for (const Vec3& corner : corners) boxes[piece].include(corner);
  });
  for_each_used([&](std::uint32_t piece, int turn, const auto& corners) {
    balance[piece] += turn != 0 ? 1 : -1;
    if (turn != 0)
      sums[piece].add(corners[0], corners[turn > 0 ? 1 : 2], corners[turn > 0 ? 2 : 1], boxes[piece].center());
  });
  for (std::uint32_t p = 0; p < patches.size(); ++p) {
    const std::uint32_t piece = piece_of[p];
    if (wanted[piece] != 0 && weight[piece] == 0 && balance[piece] > 0 && is_solid(sums[piece], false))
      turns[p] = found[p];
  }
}

}  // namespace

Pieces find_pieces(MeshView mesh, const MeshEdges& edges, Patches& patches) {
  const Borders borders = find_borders(edges, patches);
  const std::vector<TurnPair> pairs = pairs_of(borders);
  std::vector<std::uint32_t> piece_of;
  Pieces found = join_patches(patches, pairs, piece_of);
  const auto weights_of = [&](const std::vector<std::int8_t>& turns) {
    return weights(borders, piece_of, found.size(), turns);
  };
  std::vector<std::int8_t> turns = greedy_turns(patches.size(), pairs);
  const std::vector<std::int64_t> as_is = weights_of(std::vector<std::int8_t>(patches.size(), 1)),
                                  greedy = weights_of(turns);
  let_majority_stay(patches, piece_of, found.size(), turns);

  std::vector<std::uint8_t> left_over(found.size());
  for (std::size_t n = 0; n < found.size(); ++n) left_over[n] = found.unorientable[n] == 0 && as_is[n] > 0;
  const std::vector<std::int8_t> hull = outer_hulls(mesh, edges, patches, piece_of, left_over);
  const std::vector<std::int64_t> of_hull = weights_of(hull);
  std::vector<std::uint8_t> has_hull(found.size());
  for (std::size_t p = 0; p < hull.size(); ++p) has_hull[piece_of[p]] |= hull[p] != 0 && of_hull[piece_of[p]] == 0;

  for (std::size_t p = 0; p < turns.size(); ++p) {
    const std::uint32_t piece = piece_of[p];
    if (has_hull[piece] != 0) {
      turns[p] = hull[p];
    } else if (found.unorientable[piece] != 0 || as_is[piece] <= greedy[piece]) {
      turns[p] = 1;
    }
  }
  std::vector<std::uint8_t> uncancelled(found.size());
  const std::vector<std::int64_t> chosen = weights_of(turns);
  for (std::size_t n = 0; n < found.size(); ++n)
    uncancelled[n] = left_over[n] != 0 && has_hull[n] == 0 && chosen[n] > 0;
  if (std::ranges::count(uncancelled, 0) != std::ssize(uncancelled))
    leave_out_what_does_not_cancel(mesh, borders, patches, piece_of, uncancelled, turns);
  for (std::size_t t = 0; t < patches.turn.size(); ++t) {
    const int turn = turns[patches.of[t]];
    found.walls += turn == 0 && patches.turn[t] != 0;
    patches.turn[t] = static_cast<std::int8_t>(turn * patches.turn[t]);
  }
  mark_open(edges, patches, found);
  return found;
}

}  // namespace standoff
