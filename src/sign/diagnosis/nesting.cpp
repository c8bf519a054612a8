// SPDX-License-Identifier: Apache-2.0
// Which parts of a mesh lie inside which others. A part that contains another one is called its ancestor.
//
// 1. The boxes of the parts are sorted, so that ancestors come first. Boxes alone say which parts may be ancestors.
// 2. Each part gets three points. A row along x through a point crosses the surfaces of possible ancestors
//    (PartCrossings); their winding numbers about the point say which of them are ancestors. Points on one row are
//    answered together, by one sweep along it.
// 3. An ancestor counts if at least two of the three points say so (Votes).
#include "sign/diagnosis/nesting.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "sign/diagnosis/part_crossings.h"

namespace standoff {
namespace {

// The numbers of the solid parts in the order of their boxes. A box that contains another one has no smaller sum of
// sides, also when rounded, no larger min and no smaller max.
std::vector<std::uint32_t> in_order(std::span<const Part> parts) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t n = 0; n < parts.size(); ++n)
    if (parts[n].solid) order.push_back(n);
  std::ranges::sort(order, {}, [&](std::uint32_t n) {
    const auto& [min, max] = parts[n].bounds;
    const Vec3 e = max - min;
    return std::tuple(-(e.x + e.y + e.z), min.x, min.y, min.z, -max.x, -max.y, -max.z, n);
  });
  return order;
}

// A trie: a node stands for a sequence of ascending numbers, and its parent for the same sequence without the last one.
// Equal sequences are one node, so the ancestors of thousands of nested shells, each of which has one more than the
// next, take linear memory.
class Trie {
 public:
  static constexpr std::uint32_t kRoot = 0;  // the empty sequence

  /// The node of the sequence of `parent` and then `last`.
  std::uint32_t child(std::uint32_t parent, std::uint32_t last) {
    const auto [place, is_new] =
        children_.try_emplace(std::uint64_t{parent} << 32 | last, static_cast<std::uint32_t>(nodes_.size()));
    if (is_new) nodes_.push_back({parent, last, nodes_[parent].length + 1});
    return place->second;
  }
  std::int32_t length(std::uint32_t node) const { return nodes_[node].length; }
  std::uint32_t last(std::uint32_t node) const { return nodes_[node].last; }  // not of the root
  std::uint32_t parent(std::uint32_t node) const { return nodes_[node].parent; }
  std::size_t size() const { return nodes_.size(); }

 private:
  struct Node {
    std::uint32_t parent, last;
    std::int32_t length;
  };
  std::vector<Node> nodes_ = {{kRoot, 0, 0}};
  std::unordered_map<std::uint64_t, std::uint32_t> children_;
};

// The active set of a sweep: the parts that its point is inside of, in their order.
class ActiveParts {
 public:
  ActiveParts(const PartOrder& order, Trie& trie) : order_(order), trie_(trie) {}

  void clear() {
    active_.clear();
    nested_.clear();
  }
  void enter(std::uint32_t n) { active_.insert(cut_at(n), n); }
  void leave(std::uint32_t n) { active_.erase(cut_at(n)); }

  // The node of the active parts that may contain part n. Adds the work done to `work`.
  std::uint32_t ancestors_of(std::uint32_t n, std::int64_t& work) {
    const auto before = static_cast<std::size_t>(std::ranges::lower_bound(active_, n) - active_.begin());
    for (std::size_t next = nested_.size(); next < before; ++next, ++work) {
      if (next > 0 && !order_.may_contain(active_[next - 1], active_[next])) break;
      nested_.push_back(trie_.child(next > 0 ? nested_.back() : Trie::kRoot, active_[next]));
    }
    // What contains a box that contains n contains it too.
    std::size_t most = std::min(before, nested_.size());
    for (; most > 0 && !order_.may_contain(active_[most - 1], n); ++work) --most;
    std::uint32_t node = most > 0 ? nested_[most - 1] : Trie::kRoot;
    for (std::size_t next = nested_.size(); next < before; ++next, ++work)
      if (order_.may_contain(active_[next], n)) node = trie_.child(node, active_[next]);
    return node;
  }

 private:
  // Where n is or would be. What was known of the active parts from there on is forgotten.
  std::vector<std::uint32_t>::iterator cut_at(std::uint32_t n) {
    const auto place = std::ranges::lower_bound(active_, n);
    nested_.resize(std::min(nested_.size(), static_cast<std::size_t>(place - active_.begin())));
    return place;
  }

  const PartOrder& order_;
  Trie& trie_;
  std::vector<std::uint32_t> active_;
  std::vector<std::uint32_t>
      nested_;  // nodes of its first members, as far as the box of each contains that of the next
};

constexpr std::size_t kVotes = 3;  // of each part

// What the points of each part say of its ancestors.
class Votes {
 public:
  Votes(const PartCrossings& crossings, const PartOrder& order, std::int64_t most_crossings, std::int64_t most_work)
      : crossings_(crossings),
        active_(order, trie_),
        most_crossings_(most_crossings),
        most_work_(most_work),
        votes_(order.size()),
        winding_(order.size()) {}

  // The next vote, of all parts that `points` has one of. The rows of the points for which `is_first` ask not only
  // their own parts but also the parts that they meet, so that one row suffices for thousands of nested shells. All
  // other parts are asked by rows of their own. False if there is too much to do.
  bool vote(std::span<const PartPoint> points, std::span<const std::uint8_t> is_first);

  struct Result {
    std::int32_t depth = 0;
    std::uint32_t parent = 0;  // if the depth is not 0
  };
  // How many ancestors part n has by most of its votes, and the last one of them in the order.
  Result result(std::uint32_t n) const;

 private:
  bool ask(std::span<const PartPoint> rows);
  void ask_row(const PartPoint& row, std::span<const PartCrossing> crossings);
  void add_met(const PartPoint& row, std::span<const PartCrossing> crossings);
  void sweep(std::span<const PartCrossing> crossings);

  // What is kept counts as so much work that it takes some 500 MB at the most, given kMostNestingTests.
  bool is_too_much() const {
    constexpr std::int64_t kWorkPerNode = 100;
    return work_ + kWorkPerNode * static_cast<std::int64_t>(trie_.size() - 1) > most_work_;
  }

  const PartCrossings& crossings_;
  Trie trie_;
  ActiveParts active_;
  std::int64_t most_crossings_;  // in memory at a time
  std::int64_t most_work_, work_ = 0;
  std::size_t round_ = 0;
  std::vector<std::array<std::uint32_t, kVotes>> votes_;  // nodes
  std::vector<std::uint8_t> waits_;                       // for each part: it has not voted in this round
  std::vector<std::int32_t> winding_;                     // of each part about the point of the sweep
  std::vector<PartPoint> asked_;                          // of one row, by x
};

bool Votes::vote(std::span<const PartPoint> points, std::span<const std::uint8_t> is_first) {
  waits_.assign(votes_.size(), 0);
  std::vector<PartPoint> rows;
  rows.reserve(points.size());
  for (const PartPoint& point : points) {
    waits_[point.part] = 1;
    if (is_first[point.part] != 0) rows.push_back(point);
  }
  // An order that does not depend on that of the triangles: which row asks a part is that of the first one it is on.
  std::ranges::sort(rows, {}, [](const PartPoint& p) { return std::tuple(p.at.y, p.at.z, p.at.x); });
  if (!ask(rows)) return false;
  rows.clear();
  for (const PartPoint& point : points)
    if (waits_[point.part] != 0) rows.push_back(point);
  for (const PartPoint& row : rows) waits_[row.part] = 0;  // none of them is asked on another one's row
  if (!ask(rows)) return false;
  ++round_;
  return true;
}

bool Votes::ask(std::span<const PartPoint> rows) {
  if (rows.empty()) return true;
  const std::int64_t tests = crossings_.tests(rows);
  work_ += tests;
  if (is_too_much()) return false;
  // Half of the rows at a time where there are too many crossings; those of one row always fit.
  const std::int64_t most = rows.size() == 1 ? tests : std::min(tests, most_crossings_);
  std::vector<PartCrossing> crossings;
  if (!crossings_.find(rows, static_cast<std::size_t>(most), crossings)) {
    work_ -= tests;
    return ask(rows.first(rows.size() / 2)) && ask(rows.subspan(rows.size() / 2));
  }
  auto next = crossings.begin();
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const auto first = next;
    while (next != crossings.end() && next->row == n) ++next;
    ask_row(rows[n], std::span<const PartCrossing>(first, next));
    if (is_too_much()) return false;
  }
  return true;
}

void Votes::ask_row(const PartPoint& row, std::span<const PartCrossing> crossings) {
  asked_.assign(1, {row.at, row.part});
  waits_[row.part] = 0;
  add_met(row, crossings);
  std::ranges::sort(asked_, {}, [](const PartPoint& q) { return std::pair(q.at.x, q.part); });
  sweep(crossings);
}

// Parts that the row meets are asked where it enters them, in the second round where it leaves them.
void Votes::add_met(const PartPoint& row, std::span<const PartCrossing> crossings) {
  for (auto next = crossings.begin(); next != crossings.end();) {
    const std::uint32_t part = next->part;
    double low = 0, high = 0;
    const bool asked = waits_[part] != 0;
    for (bool first = true; next != crossings.end() && next->part == part; ++next, first = false) {
      if (!asked) continue;
      const double x = crossings_.x_of(row.at, *next);
      low = first ? x : std::min(low, x);
      high = first ? x : std::max(high, x);
    }
    if (!asked) continue;
    waits_[part] = 0;
    asked_.push_back({{round_ == 1 ? high : low, row.at.y, row.at.z}, part});
  }
}

// Answers all points of a row, from its far end. Which of them are past a crossing is decided by exact predicates; as
// they are monotone along the row, by bisection.
void Votes::sweep(std::span<const PartCrossing> crossings) {
  // The steps of the winding numbers before the point n, by n and part.
  struct Step {
    std::size_t before;
    std::uint32_t part;
    std::int32_t step;
  };
  std::vector<Step> steps;
  for (const PartCrossing& crossing : crossings) {
    const auto past =
        std::ranges::partition_point(asked_, [&](const PartPoint& q) { return !crossings_.is_past(q.at, crossing); });
    if (past != asked_.begin())
      steps.push_back({static_cast<std::size_t>(past - asked_.begin()), crossing.part, crossing.step});
  }
  std::ranges::sort(
      steps, [](const Step& a, const Step& b) { return a.before != b.before ? a.before > b.before : a.part < b.part; });
  auto next = steps.begin();
  for (std::size_t n = asked_.size(); n > 0; --n) {
    while (next != steps.end() && next->before == n) {
      const std::uint32_t part = next->part;
      const bool was_in = winding_[part] != 0;
      for (; next != steps.end() && next->before == n && next->part == part; ++next) winding_[part] += next->step;
      const bool is_in = winding_[part] != 0;
      if (is_in && !was_in) active_.enter(part);
      if (was_in && !is_in) active_.leave(part);
    }
    const PartPoint& point = asked_[n - 1];
    votes_[point.part][round_] = active_.ancestors_of(point.part, work_);
  }
  for (const PartCrossing& crossing : crossings) winding_[crossing.part] = 0;
  active_.clear();
}

Votes::Result Votes::result(std::uint32_t n) const {
  Result found;
  std::array<std::uint32_t, kVotes> left = votes_[n];
  for (;;) {
    for (const auto& [a, b] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
      if (left[a] != left[b]) continue;  // else these two outvote the third
      if (found.depth == 0) found.parent = trie_.last(left[a]);
      found.depth += trie_.length(left[a]);
      return found;
    }
    // All sequences ascend: the greatest number of all is the last one wherever it is.
    std::uint32_t greatest = 0;
    for (const std::uint32_t node : left)
      if (node != Trie::kRoot) greatest = std::max(greatest, trie_.last(node));
    int votes = 0;
    for (std::uint32_t& node : left) {
      if (node == Trie::kRoot || trie_.last(node) != greatest) continue;
      node = trie_.parent(node);
      ++votes;
    }
    if (votes > 1 && found.depth++ == 0) found.parent = greatest;
  }
}

// A point of a triangle that does not depend on the order of its corners: on no edge, and on no line that a symmetric
// shape would have, where rays pass through many edges and need exact arithmetic.
Vec3 point_of(std::array<Vec3, 3> corners) {
  std::ranges::sort(corners,
                    [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
  return corners[0] + (corners[1] - corners[0]) * 0.3 + (corners[2] - corners[0]) * 0.23;
}

// Three points of each part that is `wanted`, of different triangles: the first and last one by x, and the first one by
// y. They do not depend on the order of the triangles.
std::array<std::vector<PartPoint>, kVotes> points_of(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of,
                                                     const std::vector<std::uint8_t>& wanted) {
  const auto before_in_x = [](const Vec3& a, const Vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  const auto before_in_y = [](const Vec3& a, const Vec3& b) {
    return std::tie(a.y, a.z, a.x) < std::tie(b.y, b.z, b.x);
  };
  std::vector<std::uint32_t> place(wanted.size(), Nesting::kNone);
  std::array<std::vector<PartPoint>, kVotes> points;
  for (auto& some : points) some.reserve(static_cast<std::size_t>(std::ranges::count(wanted, 1)));
  for (std::size_t t = 0; t < part_of.size(); ++t) {
    const std::uint32_t part = part_of[t];
    if (mesh.use_of(t) == 0 || part == Nesting::kNone || wanted[part] == 0) continue;
    const Vec3 point = point_of(mesh.mesh.corners(t));
    if (place[part] == Nesting::kNone) {
      place[part] = static_cast<std::uint32_t>(points[0].size());
      for (std::vector<PartPoint>& some : points) some.push_back({point, part});
    }
    const auto chosen = [&](std::size_t n) -> Vec3& { return points[n][place[part]].at; };
    if (before_in_x(point, chosen(0))) chosen(0) = point;
    if (before_in_x(chosen(1), point)) chosen(1) = point;
    if (before_in_y(point, chosen(2))) chosen(2) = point;
  }
  return points;
}

}  // namespace

Nesting find_nesting(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of, std::span<const Part> parts,
                     std::int64_t most_tests) {
  Nesting nesting;
  nesting.depth.resize(parts.size());
  nesting.parent.resize(parts.size(), Nesting::kNone);
  const std::vector<std::uint32_t> part_at = in_order(parts);
  if (part_at.size() < 2) return nesting;
  std::vector<Box> boxes;
  boxes.reserve(part_at.size());
  std::vector<std::uint32_t> number_of(parts.size(), Nesting::kNone), numbers;
  for (const std::uint32_t part : part_at) {
    number_of[part] = static_cast<std::uint32_t>(boxes.size());
    boxes.push_back(parts[part].bounds);
  }
  numbers.reserve(part_of.size());
  for (const std::uint32_t part : part_of) numbers.push_back(number_of[part]);
  const PartOrder order(std::move(boxes));
  const Candidates candidates = find_candidates(order, most_tests);
  nesting.known = candidates.tests <= most_tests;
  if (!nesting.known) return nesting;

  const auto all_points = points_of(mesh, numbers, candidates.inner);
  for (std::uint32_t& number : numbers)  // what contains nothing need not be met
    if (number != Nesting::kNone && candidates.innermost[number] != 0) number = Nesting::kNone;
  const PartCrossings crossings(mesh, numbers, order);
  // A quarter of the triangles, so that crossings take little beside the edges of the mesh; never more than triangles
  // (diagnosis_bytes.cpp). The part is a choice.
  const auto most_crossings =
      static_cast<std::int64_t>(std::max(part_of.size() / 4, std::min(part_of.size(), std::size_t{1} << 14)));
  Votes votes(crossings, order, most_crossings, most_tests - candidates.tests);
  for (const std::vector<PartPoint>& points : all_points)
    if (!votes.vote(points, candidates.innermost)) {
      nesting.known = false;
      return nesting;
    }
  for (std::uint32_t n = 0; n < order.size(); ++n) {
    if (candidates.inner[n] == 0) continue;
    const auto [depth, parent] = votes.result(n);
    nesting.depth[part_at[n]] = depth;
    if (depth > 0) nesting.parent[part_at[n]] = part_at[parent];
  }
  return nesting;
}

}  // namespace standoff
