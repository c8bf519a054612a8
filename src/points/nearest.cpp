// SPDX-License-Identifier: Apache-2.0
#include "points/nearest.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/threads.h"
#include "geometry/triangle_box.h"

namespace standoff {
namespace {

using Blocked = tbb::blocked_range<std::size_t>;

}  // namespace

void SortedPoints::sort(const TriangleIndex& index, std::span<const Vec3> points, HugePageVector<std::uint32_t>& order,
                        HugePageVector<Vec3>& in_order) {
  struct Near {
    Box box;
    std::size_t count = 0;
  };
  const auto add = [&](const Blocked& range, Near near) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      const Vec3 local = index.local(points[n]);
      if (!index.is_near(local)) continue;
      near.box.include(local);
      ++near.count;
    }
    return near;
  };
  const auto both = [](const Near& a, const Near& b) {
    return Near{{min(a.box.min, b.box.min), max(a.box.max, b.box.max)}, a.count + b.count};
  };
  const bool is_alone = points.size() <= kAlone;
  const Blocked all(0, points.size(), 8192);
  const Near near = is_alone ? add(all, {}) : tbb::parallel_reduce(all, Near{}, add, both);
  const auto for_all = [&](const auto& work) { is_alone ? work(all) : tbb::parallel_for(all, work); };
  order.resize(points.size());
  in_order.resize(points.size());

  low_ = near.box.min;
  const double side = near.count > 0 ? near.box.longest_side() : 0;
  cell_ = side > 0 ? side / kSide : 1;
  const double to_cells = 1 / cell_;
  keyed_.resize(near.count);
  const auto key = [&](std::size_t n) {
    const Vec3 at = (index.local(points[n]) - low_) * to_cells;
    const auto cell = [](double v) { return static_cast<std::uint32_t>(v < kSide - 1 ? v : double{kSide - 1}); };
    return static_cast<std::uint32_t>(morton(cell(at.x), cell(at.y), cell(at.z)));
  };
  if (near.count == points.size()) {
    for_all([&](const Blocked& range) {
      for (std::size_t n = range.begin(); n < range.end(); ++n) keyed_[n] = {key(n), static_cast<std::uint32_t>(n)};
    });
  } else {
    std::size_t place = 0, far = near.count;
    for (std::size_t n = 0; n < points.size(); ++n) {
      const auto number = static_cast<std::uint32_t>(n);
      if (index.is_near(index.local(points[n])))
        keyed_[place++] = {key(n), number};
      else
        order[far++] = number;
    }
  }
  if (is_alone)
    std::ranges::sort(keyed_, {}, [](const KeyedIndex& one) { return std::uint64_t{one.key} << 32 | one.index; });
  else
    radix_sort(keyed_, tbb::this_task_arena::max_concurrency());
  for_all([&](const Blocked& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      if (n < near.count) order[n] = keyed_[n].index;
      in_order[n] = points[order[n]];
    }
  });
}

SortedPoints::Keys SortedPoints::keys_of(const cpu::Cell& cell, unsigned octants) {
  const std::uint64_t first = morton(static_cast<std::uint64_t>(cell.low[0]), static_cast<std::uint64_t>(cell.low[1]),
                                     static_cast<std::uint64_t>(cell.low[2]));
  const auto side = static_cast<std::uint64_t>(cell.side);
  return {first, first + side * side * side * octants / 8};
}

std::int64_t SortedPoints::first_at(std::uint64_t key, Range among) const {
  const auto at = std::partition_point(keyed_.begin() + among.begin, keyed_.begin() + among.end,
                                       [&](const KeyedIndex& keyed) { return keyed.key < key; });
  return at - keyed_.begin();
}

SortedPoints::Range SortedPoints::first_of(Range range, const cpu::Cell& cell, unsigned octants) const {
  return {range.begin, first_at(keys_of(cell, octants).end, range)};
}

std::int64_t SortedPoints::count_in(const cpu::Cell& cell) const {
  const Keys keys = keys_of(cell, 8);
  const Range all{0, size()};
  return first_at(keys.end, all) - first_at(keys.first, all);
}

cpu::CullCell SortedPoints::cull_cell(const cpu::Cell& cell) const {
  const double lows[3] = {low_.x, low_.y, low_.z};
  const double half = static_cast<double>(cell.side) / 2 * cell_;
  cpu::CullCell box;
  box.reach = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double center = lows[axis] + static_cast<double>(cell.low[axis]) * cell_ + half;
    box.center[axis] = static_cast<float>(center);
    // The cells of points are rounded, and so is the center: by some millionths of the mesh's size.
    box.half[axis] = static_cast<float>(half + std::abs(center - double{box.center[axis]})) * (1 + 1e-6f) + 1e-4f;
  }
  return box;
}

namespace {

using namespace cpu;

constexpr int kLevels = SortedPoints::kBits + 1;

// The half extents of boxes of points are rounded up by this share, and by this number of grid units.
constexpr float kHalfSlack = 1e-6f;

// These decide when each point of a cell descends the BVH alone (is_sparse). The values are measured, and arbitrary
// within a factor of two. Points per triangle whose middle is in the cell; smaller cells have the same share:
constexpr std::int64_t kFewOfInside = 2;
// Candidates of the cell per point, if there are few points; smaller cells would have fewer, but not few enough:
constexpr std::int64_t kManyCandidates = 12, kFewPoints = 512;

// Up to this number of points descend the BVH unsorted, each alone: the candidates that they share do not pay for
// lists.
constexpr std::size_t kFewAlone = 32;
static_assert(kFewAlone <= PointGroup::kMost);

// Fills a group with points near the mesh, and returns their box.
CullCell fill_group(const TriangleIndex& index, std::span<const Vec3> points, PointGroup& group) {
  group.count = static_cast<int>(points.size());
  group.scale = index.scale();
  Box box;
  for (int n = 0; n < group.count; ++n) {
    const Vec3 world = points[static_cast<std::size_t>(n)];
    group.at[n][0] = world.x * group.scale, group.at[n][1] = world.y * group.scale;
    group.at[n][2] = world.z * group.scale, group.at[n][3] = 0;
    box.include(index.local(world));
  }
  const Vec3 middle = box.min + (box.max - box.min) * 0.5;
  const double middles[3] = {middle.x, middle.y, middle.z};
  const double lows[3] = {box.min.x, box.min.y, box.min.z}, highs[3] = {box.max.x, box.max.y, box.max.z};
  CullCell cell;
  cell.reach = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    cell.center[axis] = static_cast<float>(middles[axis]);
    const double center = cell.center[axis];
    group.middle[axis] = center;
    group.center[axis] = index.bvh().frame().center[axis] + center;
    cell.half[axis] =
        static_cast<float>(std::max(center - lows[axis], highs[axis] - center)) * (1 + kHalfSlack) + kHalfSlack;
    group.half[axis] = cell.half[axis];
  }
  group.center[3] = 0;
  const int lanes = (group.count + kLanes - 1) / kLanes * kLanes;
  for (int n = 0; n < lanes; ++n) {
    const double(&at)[4] = group.at[std::min(n, group.count - 1)];
    for (int axis = 0; axis < 3; ++axis) group.local[axis][n] = static_cast<float>(at[axis] - group.center[axis]);
    group.upper_sq[n] = std::numeric_limits<float>::infinity();
    group.nearest_sq[n] = std::numeric_limits<double>::infinity();
    group.nearest[n] = kNoTriangle;
  }
  return cell;
}

NearestTriangle answer_of(const PointGroup& group, int n) {
  return {std::sqrt(group.nearest_sq[n]) / group.scale, group.nearest[n]};
}

// The memory that a thread uses for one group after another, and keeps for later calls: the lists are large, and
// allocating them costs more than answering a few points.
class ThreadState {
 public:
  /// Makes the lists ready for a call, which next_call() numbers. Forgets the cells of earlier calls.
  void prepare(const TriangleIndex& index, std::uint64_t call) {
    if (call == call_) return;
    call_ = 0;
    const std::int64_t entries = index.bvh().entries();
    if (entries > entries_) {
      lists_.reset();
      entries_ = 0;
      lists_.emplace(index.culling().make_lists(kLevels));
      entries_ = entries;
    }
    for (CellCandidates& level : lists_->levels) level.cell = {};
    group.start = 0;
    call_ = call;
  }
  static std::uint64_t next_call() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
  }
  CandidateLists& lists() { return *lists_; }

  PointGroup group;
  PointTable table;

 private:
  std::optional<CandidateLists> lists_;
  std::int64_t entries_ = 0;  // the lists have room for an index with this number of entries
  std::uint64_t call_ = 0;
};

// Answers points of a sorted block, in cells within cells (field/cpu/candidate_culling.h).
class PointBlock {
 public:
  PointBlock(const TriangleIndex& index, const PointKernels& kernels, const SortedPoints& sorted,
             std::span<const Vec3> points, std::span<NearestTriangle> out)
      : index_(index), kernels_(kernels), sorted_(sorted), points_(points), out_(out) {}

  void answer(SortedPoints::Range range, ThreadState& state) const {
    visit(0, {{0, 0, 0}, {SortedPoints::kSide, SortedPoints::kSide, SortedPoints::kSide}, SortedPoints::kSide}, {},
          range, state);
  }

 private:
  void visit(int level, const Cell& cell, const References& near, SortedPoints::Range range, ThreadState& state) const {
    const CellCandidates& own = enter(level, cell, near, state.lists());
    if (is_sparse(own, range)) return answer_each(range, state);
    if (cell.side == 1) return answer_groups(own, near, range, state);
    visit_parts(level, own, {0, 8}, range, state);
  }

  // Octants of a cell that follow each other along the curve: all, a half, a quarter or one of them.
  struct Octants {
    unsigned first, count;
  };

  void visit_parts(int level, const CellCandidates& own, Octants parts, SortedPoints::Range range,
                   ThreadState& state) const {
    if (range.size() == 0) return;
    if (range.size() <= PointGroup::kMost) return answer_group(own, references_of(own.points, parts), range, state);
    if (parts.count == 1) {
      Cell octant[8];
      halves(own.cell, octant);
      return visit(level + 1, octant[parts.first], references_of(own.points, parts), range, state);
    }
    const unsigned half = parts.count / 2, middle = parts.first + half;
    const SortedPoints::Range before = sorted_.first_of(range, own.cell, middle);
    visit_parts(level, own, {parts.first, half}, before, state);
    visit_parts(level, own, {middle, half}, {before.end, range.end}, state);
  }

  // The surface points near the corners of the box of some octants.
  static References references_of(const SurfacePoints& points, Octants parts) {
    References near;
    near.count = References::kMost;
    unsigned low[3], length[3];
    for (unsigned axis = 0; axis < 3; ++axis) {
      low[axis] = parts.first >> axis & 1;
      length[axis] = parts.count >> axis > 1 ? 2 : 1;
    }
    for (unsigned n = 0; n < References::kMost; ++n) {
      const auto at = [&](unsigned axis) { return low[axis] + (n >> axis & 1) * length[axis]; };
      std::ranges::copy(points.at[at(2)][at(1)][at(0)], near.at[n]);
    }
    return near;
  }

  // Returns the candidates of a cell. Requires that its parent was entered before.
  const CellCandidates& enter(int level, const Cell& cell, const References& near, CandidateLists& lists) const {
    CellCandidates& own = lists.levels[static_cast<std::size_t>(level)];
    if (own.cell == cell) return own;
    const CandidateCulling& culling = index_.culling();
    const CellTarget target{sorted_.cull_cell(cell), near};
    const BoxArrays& parent =
        level == 0 ? culling.roots() : lists.levels[static_cast<std::size_t>(level) - 1].list.arrays();
    culling.narrow(parent, target, opened_length(target.samples), own.list, lists.nodes);
    own.points = culling.points_of(target.samples, own.list.arrays());
    own.cell = cell;
    return own;
  }

  // Answers the points of a cell that is not divided.
  void answer_groups(const CellCandidates& own, const References& near, SortedPoints::Range range,
                     ThreadState& state) const {
    for (; range.size() > PointGroup::kMost; range.begin += PointGroup::kMost)
      answer_group(own, near, {range.begin, range.begin + PointGroup::kMost}, state);
    answer_group(own, near, range, state);
  }

  void answer_group(const CellCandidates& own, const References& near, SortedPoints::Range range,
                    ThreadState& state) const {
    PointGroup& group = state.group;
    const CellTarget target{gather(range, group), near};
    const CandidateCulling& culling = index_.culling();
    CandidateLists& lists = state.lists();
    const auto look_at = [&](const BoxArrays& boxes) {
      kernels_.look_at(index_.tree(), boxes.entry, boxes.count, group, state.table);
    };
    if (culling.narrow(own.list.arrays(), target, 0, lists.cell, lists.nodes))
      look_at(lists.cell.arrays());
    else
      while (culling.next_part(target, lists.cell, lists)) look_at(lists.part.arrays());
    take_answers(range, group);
  }

  // Whether a cell has too many triangles for its points to share candidates. `range` holds the cell's points that this
  // task answers; if they are few, all points of the cell are counted.
  bool is_sparse(const CellCandidates& own, SortedPoints::Range range) const {
    const std::int64_t points = range.size() <= kFewPoints ? range.size() : sorted_.count_in(own.cell);
    const CullCell cell = sorted_.cull_cell(own.cell);
    const BoxArrays& boxes = own.list.arrays();
    std::int64_t all = 0, inside = 0;
    for (std::int64_t n = 0; n < boxes.count; ++n) {
      const std::int64_t triangles = index_.bvh().triangles_in(boxes.entry[n]);
      bool is_inside = true;
      for (int axis = 0; axis < 3; ++axis)
        is_inside &= std::abs(boxes.low[axis][n] + boxes.high[axis][n] - 2 * cell.center[axis]) <= 2 * cell.half[axis];
      all += triangles;
      if (is_inside) inside += triangles;
    }
    return points < kFewOfInside * inside || (points <= kFewPoints && all > kManyCandidates * points);
  }

  void answer_each(SortedPoints::Range range, ThreadState& state) const {
    for (; range.size() > 0; range.begin += PointGroup::kMost) {
      const SortedPoints::Range some{range.begin, std::min(range.end, range.begin + PointGroup::kMost)};
      gather(some, state.group);
      kernels_.look_at_all(index_.tree(), state.group, state.table);
      take_answers(some, state.group);
    }
  }

  void take_answers(SortedPoints::Range range, const PointGroup& group) const {
    for (int n = 0; n < group.count; ++n) out_[static_cast<std::size_t>(range.begin + n)] = answer_of(group, n);
  }

  CullCell gather(SortedPoints::Range range, PointGroup& group) const {
    return fill_group(
        index_, points_.subspan(static_cast<std::size_t>(range.begin), static_cast<std::size_t>(range.size())), group);
  }

  const TriangleIndex& index_;
  const PointKernels& kernels_;
  const SortedPoints& sorted_;
  std::span<const Vec3> points_;  // in Morton order
  std::span<NearestTriangle> out_;
};

// Points of a task: many, so that the upper cells cost little; few, so that all threads have work.
constexpr std::int64_t kTask = 4096;

// Answers up to a group of points, each by itself.
void answer_alone(const TriangleIndex& index, const PointKernels& kernels, std::span<const Vec3> points,
                  std::span<NearestTriangle> out) {
  const auto is_in_float = [&](const Vec3& point) { return index.is_in_float(index.local(point)); };
  for (std::size_t first = 0, end; first < points.size(); first = end) {
    end = first + 1;
    if (!is_in_float(points[first])) {
      out[first] = nearest_triangle(index.bvh(), index.mesh(), points[first]);
      continue;
    }
    while (end < points.size() && is_in_float(points[end])) ++end;
    PointGroup group;
    PairTable table;
    fill_group(index, points.subspan(first, end - first), group);
    kernels.look_at_all(index.tree(), group, table);
    for (std::size_t n = first; n < end; ++n) out[n] = answer_of(group, static_cast<int>(n - first));
  }
}

// Answers each point by itself, in the caller's order.
void answer_few(const TriangleIndex& index, const PointKernels& kernels, std::span<const Vec3> points,
                FoundTriangles& found) {
  found.order.resize(points.size());
  std::iota(found.order.begin(), found.order.end(), 0u);
  found.points.assign(points.begin(), points.end());
  answer_alone(index, kernels, points, found.nearest);
}

}  // namespace

void find_nearest(const TriangleIndex& index, const PointKernels& kernels, std::span<const Vec3> points,
                  FoundTriangles& found, ProgressMeter& progress) {
  found.nearest.resize(points.size());
  if (points.size() <= kFewAlone) {
    answer_few(index, kernels, points, found);
    return progress.advance(static_cast<std::int64_t>(points.size()));
  }
  found.sorted.sort(index, points, found.order, found.points);
  const SortedPoints& sorted = found.sorted;
  const PointBlock block(index, kernels, sorted, found.points, found.nearest);
  const std::uint64_t call = ThreadState::next_call();
  const auto answer = [&](SortedPoints::Range range) {
    {
      const KeptByThread<ThreadState> state;
      state->prepare(index, call);
      block.answer(range, *state);
    }
    progress.advance(range.size());
  };
  const auto near = static_cast<std::size_t>(sorted.size());
  if (points.size() <= kTogether) {
    if (near > 0) answer({0, sorted.size()});
  } else {
    const std::int64_t tasks = (sorted.size() + kTask - 1) / kTask;
    tbb::parallel_for(std::int64_t{0}, tasks, [&](std::int64_t task) {
      answer({task * kTask, std::min(sorted.size(), (task + 1) * kTask)});
    });
  }
  find_each(index, kernels, std::span<const Vec3>(found.points).subspan(near), std::span(found.nearest).subspan(near),
            progress);
}

void find_each(const TriangleIndex& index, const PointKernels& kernels, std::span<const Vec3> points,
               std::span<NearestTriangle> out, ProgressMeter& progress) {
  const auto answer = [&](const Blocked& range) {
    for (std::size_t first = range.begin(); first < range.end(); first += PointGroup::kMost) {
      const std::size_t count = std::min<std::size_t>(PointGroup::kMost, range.end() - first);
      answer_alone(index, kernels, points.subspan(first, count), out.subspan(first, count));
      progress.advance(static_cast<std::int64_t>(count));
    }
  };
  const Blocked all(0, points.size(), PointGroup::kMost);
  points.size() <= kTogether ? answer(all) : tbb::parallel_for(all, answer);
}

}  // namespace standoff
