// SPDX-License-Identifier: Apache-2.0
// Finds the distance of two surfaces.
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "collision/close_pairs.h"
#include "collision/collide.h"
#include "collision/distance.h"
#include "collision/gap_proof.h"
#include "collision/node_pairs.h"
#include "core/guarded.h"
#include "core/threads.h"
#include "geometry/triangle_pair.h"

namespace standoff {
namespace collision {
namespace {

// A pair that was the nearest is a good beginning while its distance is at most this many times the one it had.
// It decides time alone; other values were not measured.
constexpr double kStillNear = 1.5;

// The triangles whose corners a proof visits in the time of a step.
constexpr std::int64_t kTrianglesOfAStep = 16;

// Descends both BVHs together, the pair of nodes that may be nearest first.
class DistanceSearch {
 public:
  DistanceSearch(const QueryPair& pair, const DistanceOptions& options, Steps& steps)
      : pair_(pair),
        nodes_(pair),
        to_target_(transform_of(pair.relative)),
        node_slack_(node_slack(pair)),
        tolerance_(options.tolerance),
        best_(options.limit),
        best_sq_(best_ * best_),
        steps_(steps),
        batch_(pair) {
    lower_reach();
  }

  /// Requires bodies that do not intersect, unless the steps are spent: then it finds only a near pair.
  void run() {
    if (pair_.root_gap() > reach_) return;
    // Find a near pair first: then most pairs of nodes are farther and never enter the queue. The second descent uses
    // the direction that the first one found.
    for (int n = 0; n < kDescents; ++n) descend();
    if (found_) prove_by_boxes();
    near_ties_ = 0;
    search();
  }

  /// The same, from a pair that was the nearest at another pose. Returns false if it cannot be sure to have found what
  /// run() finds; then it may have found nothing. A search that ends without a proof has measured each pair that is as
  /// near as the best one, so its answer is the first of them, wherever it began. This one tries no proof; it makes
  /// sure that run() had none. Requires no tolerance and no limit of steps.
  bool run_from(std::uint32_t target_index, std::uint32_t probe_index, double distance_it_had) {
    has_start_ = true;
    batch_.add(target_index, probe_index);
    measure();
    if (!found_ || best_ > kStillNear * distance_it_had || proof().boxes_may_prove()) return false;
    search();
    return near_ties_ <= kWorthAProof && !proof().boxes_may_prove();
  }

  double best() const { return best_; }
  /// What is proven if the search is not finished: no pair is nearer.
  double lower() const { return lower_; }
  bool finished() const { return is_finished_; }
  bool found() const { return found_; }
  const NearestPair& nearest() const { return nearest_; }

 private:
  static constexpr int kDescents = 2;

  void search() {
    std::array<NodePair, kLanes> children;
    boxes_tried_at_ = best_;
    queue_->clear();
    for (std::optional<NodePair> least = nodes_.root(); least && !is_settled_;) {
      if (least->distance_sq > reach_sq_) return measure();
      if (steps_.are_spent()) return give_up(least->distance_sq);
      steps_.take();
      const NodePair next = *least;
      if (next.is_leaf()) {  // of two bodies that are leaves
        look_at(next);
        break;
      }
      const auto end = children.begin() + nodes_.open(next, reach_sq_, children);
      if (next.target_level + next.probe_level == 1) {
        if (!look_at_leaves({children.begin(), end})) return give_up(next.distance_sq);
        least = pop();
        continue;
      }
      const auto nearest = std::ranges::min_element(children.begin(), end, {}, &NodePair::distance_sq);
      for (auto child = children.begin(); child != end; ++child)
        if (child != nearest) push(*child);
      // It is often the least of all: then it need not wait.
      if (nearest != end && (queue_->empty() || nearest->distance_sq <= queue_->front().distance_sq)) {
        least = *nearest;
      } else {
        if (nearest != end) push(*nearest);
        least = pop();
      }
    }
    measure();
  }

  // No pair that was dropped is nearer than this: by the tolerance, once there is a best pair.
  double kept_within() const { return found_ ? best_ - tolerance_ : best_; }
  double about(double distance) const { return about_equal(distance, node_slack_); }
  // Lowers the reach: bounds above it cannot hide a pair that is nearer than the best one by more than the tolerance,
  // or that counts as about as near.
  void lower_reach() {
    const double ties = has_start_ ? kTies * about(best_) : 0;
    wanted_ = std::min((kept_within() + ties) * (1 + kFarShare), kMaxMargin);
    reach_ = static_cast<float>(wanted_ + node_slack_);
    reach_sq_ = collision::reach_sq(wanted_, node_slack_);
  }

  // Ends the search: the least bound of all nodes that wait, and what was dropped, are what is proven. A node with a
  // bound above the reach would have been dropped; this takes from a bound what lower_reach() adds, and its rounding.
  void give_up(float least_sq) {
    measure();
    const double of_nodes = (std::sqrt(static_cast<double>(least_sq)) * kRoundDown - node_slack_) / (1 + kFarShare);
    lower_ = std::max(0.0, std::min(of_nodes, kept_within()));
    is_finished_ = false;
  }

  void descend() {
    std::array<NodePair, kLanes> children;
    NodePair at = nodes_.root();
    while (!at.is_leaf()) {
      steps_.take();
      const int count = nodes_.open(at, reach_sq_, children);
      if (count == 0) return;
      at = *std::ranges::min_element(children.begin(), children.begin() + count, {}, &NodePair::distance_sq);
    }
    look_at(at);
    measure();
  }

  void push(const NodePair& pair) {
    queue_->push_back(pair);
    std::ranges::push_heap(*queue_, std::ranges::greater{}, &NodePair::distance_sq);
  }
  std::optional<NodePair> pop() {
    if (queue_->empty()) return {};
    std::ranges::pop_heap(*queue_, std::ranges::greater{}, &NodePair::distance_sq);
    const NodePair next = queue_->back();
    queue_->pop_back();
    return next;
  }

  // Looks at pairs of leaves, the nearest first; false if the steps are spent before. None of them waits its turn: the
  // best distance is nearly known by now, and to look at a few more leaves costs less than to have all wait.
  bool look_at_leaves(std::span<NodePair> leaves) {
    std::ranges::sort(leaves, {}, &NodePair::distance_sq);
    for (const NodePair& pair : leaves) {
      if (is_settled_ || pair.distance_sq > reach_sq_) break;
      if (steps_.are_spent()) return false;
      steps_.take();
      look_at(pair);
      if (best_ < boxes_tried_at_ && !has_start_) {
        boxes_tried_at_ = best_;
        prove_by_boxes();
      }
    }
    return true;
  }

  // Measures the triangles of two leaves that are near along the best pair's axes and along the target leaf's axes.
  void look_at(const NodePair& leaves) {
    const BodyBvh &target = pair_.target.body->bvh, &probe = pair_.probe.body->bvh;
    const Obb first = target.box_of(0, leaves.target), second = probe.box_of(0, leaves.probe);
    const Triple<double> offset = offset_of(to_target_, first, second);
    const LeafAxes axes[2] = {
        leaf_axes(to_target_, found_ ? best_axes_ : perpendicular_axes(offset), offset),
        leaf_axes(to_target_, {{axis_of(first, 0), axis_of(first, 1), axis_of(first, 2)}}, offset)};
    const double slack =
        leaf_slack(pair_.target.body->radius + pair_.probe.body->radius, first, second, pair_.pose_slack);
    const auto most_sq = [&] { return std::min(collision::reach_sq(wanted_, slack), reach_sq_); };
    LeafPair near[kLanes * kLanes];
    const int count = pair_.kernels.near_triangles(
        target.triangles[leaves.target], first.center, target.children_of(0, leaves.target),
        probe.triangles[leaves.probe], second.center, probe.children_of(0, leaves.probe), axes, most_sq(), near);
    // Measure the nearest few first: they exclude most of the others.
    const auto nearer = [](const LeafPair& a, const LeafPair& b) { return a.distance_sq < b.distance_sq; };
    LeafPair *next = near, *past = near + count;
    while (past - next > kPairs) {
      std::nth_element(next, next + kPairs, past, nearer);
      next = measure(leaves, next, next + kPairs);
      past = std::remove_if(next, past, [&](const LeafPair& pair) { return pair.distance_sq > most_sq(); });
    }
    measure(leaves, next, past);
    if (near_ties_ <= kWorthAProof) return;
    if (has_start_)
      is_settled_ = true;  // run() may find a proof
    else
      prove();
  }

  // Returns the first pair left. While nothing is found, every pair is measured at once; later the reach may lag
  // behind.
  LeafPair* measure(const NodePair& leaves, LeafPair* next, LeafPair* past) {
    steps_.take(past - next);
    for (const LeafPair* ahead = next; ahead != past; ++ahead) {
      fetch(pair_.target.body->corners[leaves.target * kLanes + ahead->first]);
      fetch(pair_.probe.body->corners[leaves.probe * kLanes + ahead->second]);
    }
    for (; next != past; ++next) {
      batch_.add(leaves.target * kLanes + next->first, leaves.probe * kLanes + next->second);
      if (batch_.full()) measure();
    }
    if (!found_) measure();
    return past;
  }

  // Of pairs that are equally near, the first one counts: by its triangles, the target's before the probe's.
  void measure() {
    bool nearer = false;
    batch_.measure([&](std::uint32_t target_index, std::uint32_t probe_index, double distance_sq, Vec3 of_p,
                       Vec3 of_q) {
      near_ties_ += distance_sq <= near_sq_;
      if (distance_sq >= best_sq_) {
        const bool precedes = std::pair(target_index, probe_index) < std::pair(nearest_.of_target, nearest_.of_probe);
        if (!found_ || distance_sq > best_sq_ || !precedes) return;
      }
      nearer = nearer || distance_sq < best_sq_;
      best_sq_ = distance_sq;
      nearest_ = {target_index, probe_index, of_p, of_q};
      found_ = true;
    });
    if (!nearer) return;
    best_ = std::sqrt(best_sq_);
    count_ties();
    lower_reach();
    best_axes_ = perpendicular_axes(triple_of(rotate_back(pair_.frame, nearest_.on_probe - nearest_.on_target)));
    nodes_.set_axes(leaf_axes(to_target_, best_axes_, {}));
  }

  // Counts pairs that are about as near as the best one. run() begins again when the best one has come nearer by more
  // than pairs may differ: a proof is for those that are left. So all that it has counted when a proof succeeds are
  // within two such differences of the least distance, and rounding. run_from() counts all pairs within three, of which
  // it drops none: where it has counted few, no proof was tried that could have succeeded.
  void count_ties() {
    if (has_start_) {
      near_sq_ = std::pow(best_ + kTies * about(best_), 2);
    } else if (best_ < ties_of_ - about(ties_of_) || !(ties_of_ < std::numeric_limits<double>::infinity())) {
      ties_of_ = best_;
      near_ties_ = 0;
      near_sq_ = std::pow(best_ + about(best_), 2);
    }
  }

  // Where very many pairs are about equally near.
  void prove() {
    measure();
    near_ties_ = 0;
    if (best_ == proof_tried_at_) return;
    proof_tried_at_ = best_;
    const std::size_t triangles = pair_.target.body->corners.size() + pair_.probe.body->corners.size();
    for (const Vec3& direction : proof().directions(nearest_.of_target, nearest_.of_probe)) {
      if (is_settled_) return;
      steps_.take(static_cast<std::int64_t>(triangles) / kTrianglesOfAStep);
      is_settled_ = proof().by_corners(direction, tolerance_);
    }
  }

  // The same by the boxes of both bodies alone, which costs nothing.
  void prove_by_boxes() {
    for (const Vec3& direction : proof().directions(nearest_.of_target, nearest_.of_probe))
      is_settled_ = is_settled_ || proof().by_boxes(direction, tolerance_);
  }

  GapProof proof() const { return {pair_, nearest_.on_target, nearest_.on_probe, best_}; }

  const QueryPair& pair_;
  NodePairs nodes_;
  const DoubleTransform to_target_;
  const double node_slack_, tolerance_;
  NearestPair nearest_{};
  double best_, best_sq_, wanted_ = 0, lower_ = 0;
  float reach_ = 0, reach_sq_ = 0;
  bool found_ = false, is_settled_ = false, is_finished_ = true;
  bool has_start_ = false;  // it is run_from()
  Steps& steps_;
  PerpendicularAxes best_axes_{};  // in the target's frame
  std::int64_t near_ties_ = 0;     // pairs within near_sq_, since a proof was tried
  double ties_of_ = std::numeric_limits<double>::infinity(), near_sq_ = 0;
  double proof_tried_at_ = -1, boxes_tried_at_ = 0;
  PairBatch batch_;
  const KeptByThread<std::vector<NodePair>> queue_;
};

// Whether a search may begin with the pair of a state: its answer does not depend on where it began only if it is the
// least distance.
bool may_begin_with(const DistanceState& state, const QueryPair& pair, const DistanceOptions& options) {
  return state.of_target < pair.target.body->corners.size() && state.of_probe < pair.probe.body->corners.size() &&
         options.tolerance == 0 && options.max_steps == 0;
}

}  // namespace

DistanceResult result_of(const QueryPair& pair, const NearestPair& nearest, double lower, double upper) {
  const TrianglesOfBoth triangles = pair.triangles_of(nearest.of_target, nearest.of_probe);
  const auto& [on_a, on_b] =
      pair.swapped ? std::tie(nearest.on_probe, nearest.on_target) : std::tie(nearest.on_target, nearest.on_probe);
  return {lower, upper, on_a, on_b, triangles.a, triangles.b};
}

DistanceResult beyond(double limit) {
  return {.lower = limit, .upper = std::numeric_limits<double>::infinity(), .point_a = {}, .point_b = {}};
}

DistanceResult distance_exactly(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                                const DistanceOptions& options, const Kernels& kernels, DistanceState& state) {
  const QueryPair pair(a, pose_a, b, pose_b, kernels);
  Steps steps(options.max_steps);
  if (const auto found = find_intersecting_pair(pair, 0, steps)) {
    const Vec3 point = common_point(pair.target.world(found->of_target), pair.probe.world(found->of_probe));
    state = {found->of_target, found->of_probe, 0};
    return result_of(pair, {found->of_target, found->of_probe, point, point}, 0, 0);
  }
  const bool may_intersect = steps.are_spent();
  std::optional<DistanceSearch> search(std::in_place, pair, options, steps);
  if (!may_begin_with(state, pair, options) || !search->run_from(state.of_target, state.of_probe, state.distance)) {
    search.emplace(pair, options, steps);
    search->run();
  }
  const bool finished = search->finished() && !may_intersect;
  const double proven = may_intersect ? 0 : search->lower();
  if (!search->found()) {
    DistanceResult result = beyond(finished ? options.limit : proven);
    result.finished = finished;
    return result;
  }
  const double upper = search->best();
  const NearestPair& nearest = search->nearest();
  state = {nearest.of_target, nearest.of_probe, upper};
  DistanceResult result =
      result_of(pair, nearest, finished ? std::max(0.0, upper - options.tolerance) : std::min(proven, upper), upper);
  result.finished = finished;
  return result;
}

namespace {

void check(const DistanceOptions& options) {
  if (!(options.tolerance >= 0) || !(options.limit >= 0) || !std::isfinite(options.tolerance))
    throw Error(ErrorCode::usage,
                "distance: tolerance and limit must be zero or more, and the tolerance finite; without them the "
                "distance is exact");
  if (options.max_steps < 0)
    throw Error(ErrorCode::usage, "distance: max_steps must not be negative; give 0 for no limit");
}

}  // namespace
}  // namespace collision

DistanceResult distance(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                        const DistanceOptions& options) {
  DistanceState none;
  return distance(a, pose_a, b, pose_b, options, none);
}

DistanceResult distance(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                        const DistanceOptions& options, DistanceState& state) try {
  collision::check(options);
  validate(pose_a);
  validate(pose_b);
  return collision::distance_exactly(a, pose_a, b, pose_b, options, collision::best_kernels(), state);
} catch (...) {
  throw_as_error("distance");
}

BatchResult<DistanceResult> distance_all(const Body& a, const Pose& pose_a, const Body& b,
                                         std::span<const Pose> poses_b, const DistanceOptions& options,
                                         const Execution& execution) try {
  collision::check(options);
  const bool bounded = options.tolerance != 0 || options.max_steps != 0;
  validate(bounded ? "distance: with a tolerance or most steps" : "distance", execution,
           bounded ? Runs::on_the_cpu : Runs::everywhere);
  validate(pose_a);
  collision::validate_all(poses_b);
  const collision::Kernels& kernels = collision::kernels_for(execution.simd, "distance");
  const collision::DeviceRow* const row =
      collision::find_device(bounded ? Backend::cpu : execution.backend, poses_b.size());
  BatchReport report{name_of(row ? row->backend : Backend::cpu), row ? row->device_name(execution.device) : ""};
  if (row) {
    auto results = collision::distance_on_device(*row, a, pose_a, b, poses_b, options.limit, execution, report);
    return {std::move(results), std::move(report)};
  }
  // Poses that follow each other are often near each other.
  tbb::enumerable_thread_specific<DistanceState> states;
  auto results = collision::for_each<DistanceResult>(poses_b.size(), execution.threads, [&](std::size_t n) {
    return collision::distance_exactly(a, pose_a, b, poses_b[n], options, kernels, states.local());
  });
  return {std::move(results), std::move(report)};
} catch (...) {
  throw_as_error("distance");
}

}  // namespace standoff
