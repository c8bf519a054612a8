// SPDX-License-Identifier: Apache-2.0
// On a row all questions are answered by one sweep from its far end. Which questions are past a hit is decided by exact
// predicates; as they are monotone along the row, by bisection.
#include "sign/diagnosis/nesting_votes.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace standoff {

// What is kept counts as so many steps that it takes some 400 MB at the most, given kMostNestingTests.
bool NestingVotes::is_too_much() const {
  constexpr std::int64_t kStepsPerChain = 100, kStepsPerListed = 10;
  return steps_ + kStepsPerChain * static_cast<std::int64_t>(chains_.count() - 1) +
             kStepsPerListed * static_cast<std::int64_t>(list_.size()) >
         most_steps_;
}

bool NestingVotes::vote(std::span<const PartPoint> points, std::span<const std::uint8_t> is_first) {
  waits_.assign(votes_.size(), 0);
  std::vector<PartPoint> rows;
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

bool NestingVotes::ask(std::span<const PartPoint> rows) {
  if (rows.empty()) return true;
  steps_ += search_.tests(rows);
  if (is_too_much()) return false;
  constexpr std::size_t kMostHits = 1 << 22;
  std::vector<RowHit> hits;
  if (!search_.find(rows, kMostHits, hits))
    return ask(rows.first(rows.size() / 2)) && ask(rows.subspan(rows.size() / 2));
  auto next = hits.begin();
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const auto first = next;
    while (next != hits.end() && next->row == n) ++next;
    ask_row(rows[n], std::span<const RowHit>(first, next));
    if (is_too_much()) return false;
  }
  return true;
}

void NestingVotes::ask_row(const PartPoint& row, std::span<const RowHit> hits) {
  questions_.assign(1, {row.at, row.part});
  waits_[row.part] = 0;
  add_met(row, hits);
  std::ranges::sort(questions_, {}, [](const Question& q) { return std::pair(q.at.x, q.part); });
  sweep(hits);
}

// Parts that the row meets are asked where it enters them, in the second round where it leaves them.
void NestingVotes::add_met(const PartPoint& row, std::span<const RowHit> hits) {
  for (auto next = hits.begin(); next != hits.end();) {
    const std::uint32_t part = next->part;
    double low = 0, high = 0;
    const bool asked = waits_[part] != 0;
    for (bool first = true; next != hits.end() && next->part == part; ++next, first = false) {
      if (!asked) continue;
      const double x = search_.x_of(row.at, *next);
      low = first ? x : std::min(low, x);
      high = first ? x : std::max(high, x);
    }
    if (!asked) continue;
    waits_[part] = 0;
    questions_.push_back({{round_ == 1 ? high : low, row.at.y, row.at.z}, part});
  }
}

void NestingVotes::sweep(std::span<const RowHit> hits) {
  // The steps of the winding numbers before question n, by n and part.
  struct Step {
    std::size_t before;
    std::uint32_t part;
    std::int32_t step;
  };
  std::vector<Step> steps;
  for (const RowHit& hit : hits) {
    const auto past =
        std::ranges::partition_point(questions_, [&](const Question& q) { return !search_.is_past(q.at, hit); });
    if (past != questions_.begin())
      steps.push_back({static_cast<std::size_t>(past - questions_.begin()), hit.part, hit.step});
  }
  std::ranges::sort(
      steps, [](const Step& a, const Step& b) { return a.before != b.before ? a.before > b.before : a.part < b.part; });
  auto next = steps.begin();
  for (std::size_t n = questions_.size(); n > 0; --n) {
    while (next != steps.end() && next->before == n) {
      const std::uint32_t part = next->part;
      const bool was_in = winding_[part] != 0;
      for (; next != steps.end() && next->before == n && next->part == part; ++next) winding_[part] += next->step;
      const bool is_in = winding_[part] != 0;
      if (is_in && !was_in) around_.enter(part);
      if (was_in && !is_in) around_.leave(part);
    }
    const Question& question = questions_[n - 1];
    votes_[question.part][round_] = around_.containing(question.part, list_, steps_);
  }
  for (const RowHit& hit : hits) winding_[hit.part] = 0;
  around_.clear();
}

std::uint32_t NestingVotes::last(const Containers& set) const {
  return set.listed > 0 ? list_[set.first + set.listed - 1] : chains_.last(set.chain);
}

void NestingVotes::remove_last(Containers& set) const {
  if (set.listed > 0)
    --set.listed;
  else
    set.chain = chains_.without_last(set.chain);
}

NestingVotes::Result NestingVotes::result(std::uint32_t n) const {
  const auto result_of = [&](const Containers& set) {
    return size(set) == 0 ? Result{} : Result{static_cast<std::int32_t>(size(set)), last(set)};
  };
  std::array<Containers, kVotes> left = votes_[n];
  const auto same_chains = [&](std::size_t a, std::size_t b) {
    return left[a].chain == left[b].chain && left[a].listed == 0 && left[b].listed == 0;
  };
  if (same_chains(0, 1) || same_chains(0, 2)) return result_of(left[0]);
  if (same_chains(1, 2)) return result_of(left[1]);
  // Count what is in two of them, from the last one on.
  Result found;
  for (;;) {
    std::uint32_t greatest = 0;
    int votes = 0;
    for (const Containers& set : left) {
      if (size(set) == 0 || last(set) < greatest) continue;
      votes = last(set) > greatest ? 1 : votes + 1;
      greatest = last(set);
    }
    if (votes == 0) return found;
    for (Containers& set : left)
      if (size(set) > 0 && last(set) == greatest) remove_last(set);
    if (votes > 1 && found.depth++ == 0) found.parent = greatest;
  }
}

}  // namespace standoff
