// SPDX-License-Identifier: Apache-2.0
// Decides whether two bodies intersect: by their fields alone, exactly on the CPU, and exactly on a device. Then the
// public functions.
#include "collision/collide.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "collision/close_pairs.h"
#include "collision/node_pairs.h"
#include "core/guarded.h"
#include "core/number_text.h"
#include "geometry/rounding.h"

namespace standoff {
namespace collision {
namespace {

// The error of compute() within the band of the fine field, in its spacings, with room for rounding.
constexpr double kFineError = 3e-5;
static_assert(kFineError > promised_error(kBandSamples, 1));

// Decides by the field alone. Free: no sphere of a triangle reaches the surface. Hit, with a margin: a corner of a
// triangle is nearer than the margin, as d(x) <= s + |x - x_i|. Otherwise ambiguous: without a margin, bounds of the
// distance cannot tell touching from nearly touching.
class Certify {
 public:
  Certify(const QueryPair& pair, double margin)
      : pair_(pair), kernels_(pair.kernels), margin_(margin), limit_(pair.limit(margin)) {}

  Verdict run() {
    if (pair_.apart(margin_)) return Verdict::free;
    visit(pair_.probe.body->bvh.top(), 0);
    return hit_ ? Verdict::hit : near_ ? Verdict::ambiguous : Verdict::free;
  }

 private:
  void visit(int level, std::uint32_t packet) {
    alignas(64) float gap[kLanes];
    kernels_.gaps(pair_.target.body->view, pair_.transform, pair_.probe.body->bvh.spheres[level][packet], limit_, gap);
    for (int n = 0; n < kLanes && !hit_ && !(near_ && margin_ == 0); ++n) {
      if (gap[n] > limit_) continue;
      const std::uint32_t child = packet * kLanes + n;
      if (level > 0) {
        visit(level - 1, child);
      } else {
        near_ = true;
        for (const Vec3& corner : pair_.probe.body->corners[child])
          hit_ = hit_ || upper_bound(apply(pair_.relative, corner - pair_.probe.body->middle)) <= margin_;
      }
    }
  }

  // An upper bound of the distance, from the fine sample nearest to x; infinite if the sample is clamped.
  double upper_bound(Vec3 x) const {
    const FieldBounds& f = pair_.target.body->field;
    const FieldView& view = pair_.target.body->view;
    const Vec3 u = (x - f.origin) * (1 / f.spacing);
    const auto nearest = [](double at, std::int64_t size) {
      return static_cast<std::int32_t>(std::floor(std::clamp(at, 0.0, static_cast<double>(size - 1)) + 0.5));
    };
    const std::int32_t i = nearest(u.x, f.size.x), j = nearest(u.y, f.size.y), k = nearest(u.z, f.size.z);
    const double off = length(x - f.origin - Vec3{double(i), double(j), double(k)} * f.spacing);
    const int sample = fine_sample(view, tile_of(view, i, j, k), index_in_tile(i, j, k));
    if (sample == kClampedSample) return std::numeric_limits<double>::infinity();
    // Samples were rounded down by at most a step and the error of compute().
    return (sample + 1) * f.thickness() / kClampedSample + kFineError * f.spacing + off + pair_.slack;
  }

  const QueryPair& pair_;
  const Kernels& kernels_;
  const double margin_;
  const float limit_;
  bool near_ = false, hit_ = false;
};

// Leaves of the target that are compared with packets of the probe before pairs of nodes are. Fitted on nested spheres,
// shells and stacks, which take ten times as long without pairs of nodes, and on pairs that are decided at once;
// arbitrary within a factor of two.
constexpr std::int64_t kManyLeaves = 384;

// Tests the probe's bounding spheres in the target's field, the nearest first, and triangles where the field cannot
// decide. If many are tested and none intersects, the bodies may be nested or lie on each other: spheres are too round
// to show that they do not touch. Then pairs of oriented boxes find the triangles to be tested.
class IntersectionSearch {
 public:
  IntersectionSearch(const QueryPair& pair, double margin, Steps& steps)
      : pair_(pair),
        kernels_(pair.kernels),
        margin_(margin),
        limit_(pair.limit(margin)),
        steps_(steps),
        close_(pair, limit_, kManyLeaves),
        batch_(pair) {}

  std::optional<IntersectingPair> run() {
    if (pair_.apart(margin_)) return {};
    if (visit(pair_.probe.body->bvh.top(), 0) == Visit::undecided) visit_pairs();
    return found_;
  }

 private:
  enum class Visit { none, ended, undecided };  // ended: a pair is found, or the steps are spent

  // Adds a close pair to the batch; false if one of the batch intersects, or the steps are spent.
  auto adding() {
    return [this](std::uint32_t target_index, std::uint32_t probe_index) {
      steps_.take();
      batch_.add(target_index, probe_index);
      return !batch_.full() || (settle() && !steps_.are_spent());
    };
  }

  Visit visit(int level, std::uint32_t packet) {
    if (steps_.are_spent()) return Visit::ended;
    steps_.take();
    if (level == 0) {
      // The packet reaches the surface: boxes of its triangles exclude more than the field would.
      const bool none = close_.visit(packet, ClosePairs::kAllLanes, adding());
      if (close_.is_exhausted()) return settle() ? Visit::undecided : Visit::ended;
      return none && settle() ? Visit::none : Visit::ended;
    }
    alignas(64) float gap[kLanes];
    const Sphere16& spheres = pair_.probe.body->bvh.spheres[level][packet];
    kernels_.gaps(pair_.target.body->view, pair_.transform, spheres, limit_, gap);
    int lanes[kLanes];
    const int count = lanes_within(gap, limit_, lanes);
    for (int n = 0; n < count; ++n)
      if (const Visit all = visit(level - 1, packet * kLanes + lanes[n]); all != Visit::none) return all;
    return Visit::none;
  }

  void visit_pairs() {
    const auto test = [this](std::uint32_t leaf, std::uint32_t packet) {
      return close_.visit_leaf(leaf, packet, adding());
    };
    if (NodePairs(pair_).visit_leaves(margin_, steps_, test)) settle();
  }

  // Decides the pairs of the batch; false if one of them intersects.
  bool settle() {
    return batch_.settle([this](std::uint32_t target_index, std::uint32_t probe_index, bool intersecting, auto&&) {
      bool hit = intersecting;
      if (!hit && margin_ > 0) {
        const Corners p = pair_.target.world(target_index), q = pair_.probe.world(probe_index);
        hit = closest_points(p, q).distance_sq <= margin_ * margin_;
      }
      if (hit) found_ = IntersectingPair{target_index, probe_index};
      return !hit;
    });
  }

  const QueryPair& pair_;
  const Kernels& kernels_;
  const double margin_;
  const float limit_;  // if spheres or boxes are farther away than this, they are beyond the margin
  Steps& steps_;
  ClosePairs close_;
  PairBatch batch_;
  std::optional<IntersectingPair> found_;
};

}  // namespace

Verdict certify(const QueryPair& pair, double margin) { return Certify(pair, margin).run(); }

std::optional<IntersectingPair> find_intersecting_pair(const QueryPair& pair, double margin, Steps& steps) {
  // Two bodies of the same shape at the same pose are a frequent case: their first triangles coincide.
  if (pair.relative == Pose{} && triangles_intersect(pair.target.world(0), pair.probe.world(0)))
    return IntersectingPair{0, 0};
  return IntersectionSearch(pair, margin, steps).run();
}

namespace {

// Does collide() on the CPU, without its checks.
CollisionResult collide_exactly(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b, double margin,
                                const Kernels& kernels) {
  const QueryPair pair(a, pose_a, b, pose_b, kernels);
  const auto found = find_intersecting_pair(pair, margin);
  if (!found) return {};
  const TrianglesOfBoth triangles = pair.triangles_of(found->of_target, found->of_probe);
  return {Verdict::hit, triangles.a, triangles.b};
}

// The poses of a batch on the device: enough to fill any GPU, at some 150 bytes each.
constexpr std::size_t kPosesAtOnce = std::size_t{1} << 18;

struct PreparedPose {
  PoseQuery query;
  bool apart;
};

PreparedPose prepare(const QueryPair& pair, double margin) {
  const Pose& of_b = pair.swapped ? pair.target.pose : pair.probe.pose;
  return {{transform_of(of_b), pair.transform, pair.limit(margin)}, pair.apart(margin)};
}

CollisionResult result_of(const QueryPair& bodies, const PoseAnswer& answer) {
  if (answer.verdict != DeviceVerdict::hit) return {};
  const TrianglesOfBoth triangles = bodies.triangles_of(answer.of_target, answer.of_probe);
  return {Verdict::hit, triangles.a, triangles.b};
}

}  // namespace

// Poses that a sphere and a box show to be free stay on the host. The others go to the device in batches, and the CPU
// decides those that it leaves undecided.
std::vector<CollisionResult> collide_on_device(const DeviceRow& row, const Body& a, const Pose& pose_a, const Body& b,
                                               std::span<const Pose> poses_b, double margin, const Execution& execution,
                                               BatchReport& report, int stack) {
  std::vector<CollisionResult> results(poses_b.size());
  const Kernels& kernels = kernels_for(execution.simd, "collide");
  const QueryPair bodies(a, pose_a, b, {}, kernels);  // which body is the target does not depend on poses
  for (std::size_t first = 0; first < poses_b.size(); first += kPosesAtOnce) {
    const auto poses = poses_b.subspan(first, std::min(kPosesAtOnce, poses_b.size() - first));
    const auto prepared = for_each<PreparedPose>(poses.size(), execution.threads, [&](std::size_t n) {
      return prepare(QueryPair(a, pose_a, b, poses[n], kernels), margin);
    });
    std::vector<PoseQuery> queries;
    std::vector<std::size_t> which;
    for (std::size_t n = 0; n < prepared.size(); ++n)
      if (!prepared[n].apart) queries.push_back(prepared[n].query), which.push_back(n);
    std::vector<PoseAnswer> answers(queries.size());
    if (!queries.empty())
      row.collide({.target = *bodies.target.body,
                   .probe = *bodies.probe.body,
                   .target_is_b = bodies.swapped,
                   .of_a = transform_of(pose_a),
                   .margin = margin,
                   .queries = queries,
                   .answers = answers,
                   .device = execution.device,
                   .stack = stack});
    const auto found = for_each<CollisionResult>(answers.size(), execution.threads, [&](std::size_t n) {
      const bool decided = answers[n].verdict == DeviceVerdict::free || answers[n].verdict == DeviceVerdict::hit;
      return decided ? result_of(bodies, answers[n]) : collide_exactly(a, pose_a, b, poses[which[n]], margin, kernels);
    });
    for (std::size_t n = 0; n < found.size(); ++n) {
      results[first + which[n]] = found[n];
      report.undecided += answers[n].verdict == DeviceVerdict::undecided;
      report.overflowed += answers[n].verdict == DeviceVerdict::overflow;
    }
    report.on_device += static_cast<std::int64_t>(answers.size());
  }
  report.on_device -= report.undecided + report.overflowed;
  return results;
}

}  // namespace collision

namespace {

void check(const CollideOptions& options) {
  if (options.mode != CollideMode::exact && options.mode != CollideMode::certified)
    throw Error(ErrorCode::usage, "collide: unknown mode; take CollideMode::exact or CollideMode::certified");
  if (!(options.margin >= 0) || !(options.margin <= kMaxMargin))
    throw Error(ErrorCode::usage,
                "collide: the margin must be from 0 to " + number_text(kMaxMargin) + "; give it in world units");
  if (options.containment && options.mode != CollideMode::exact)
    throw Error(ErrorCode::usage, "collide: containment is not for certified mode; take CollideMode::exact");
}

// Turns a free result into a hit if one body is inside the other.
CollisionResult with_containment(CollisionResult result, const Body& a, const Pose& pose_a, const Body& b,
                                 const Pose& pose_b) {
  if (result.hit()) return result;
  result.containment = collision::containment(a, pose_a, b, pose_b);
  if (result.containment != Containment::none) result.verdict = Verdict::hit;
  return result;
}

CollisionResult collide_checked(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                                const CollideOptions& options, const collision::Kernels& kernels) {
  if (options.mode == CollideMode::exact)
    return collision::collide_exactly(a, pose_a, b, pose_b, options.margin, kernels);
  return {.verdict = collision::certify(collision::QueryPair(a, pose_a, b, pose_b, kernels), options.margin)};
}

}  // namespace

CollisionResult collide(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                        const CollideOptions& options) try {
  check(options);
  if (options.containment) collision::require_closed(a, b);
  validate(pose_a);
  validate(pose_b);
  const CollisionResult result = collide_checked(a, pose_a, b, pose_b, options, collision::best_kernels());
  return options.containment ? with_containment(result, a, pose_a, b, pose_b) : result;
} catch (...) {
  throw_as_error("collide");
}

BatchResult<CollisionResult> collide_all(const Body& a, const Pose& pose_a, const Body& b,
                                         std::span<const Pose> poses_b, const CollideOptions& options,
                                         const Execution& execution) try {
  const bool certified = options.mode == CollideMode::certified;
  check(options);
  validate(certified ? "collide: certified mode" : "collide", execution,
           certified ? Runs::on_the_cpu : Runs::everywhere);
  if (options.containment) collision::require_closed(a, b);
  validate(pose_a);
  collision::validate_all(poses_b);
  const collision::Kernels& kernels = collision::kernels_for(execution.simd, "collide");
  const Backend backend = certified ? Backend::cpu : execution.backend;
  const collision::DeviceRow* const row = collision::find_device(backend, poses_b.size());
  BatchReport report{name_of(row ? row->backend : Backend::cpu), row ? row->device_name(execution.device) : ""};
  auto results = row ? collision::collide_on_device(*row, a, pose_a, b, poses_b, options.margin, execution, report)
                     : collision::for_each<CollisionResult>(poses_b.size(), execution.threads, [&](std::size_t n) {
                         return collide_checked(a, pose_a, b, poses_b[n], options, kernels);
                       });
  if (options.containment)
    results = collision::for_each<CollisionResult>(results.size(), execution.threads, [&](std::size_t n) {
      return with_containment(results[n], a, pose_a, b, poses_b[n]);
    });
  return {std::move(results), std::move(report)};
} catch (...) {
  throw_as_error("collide");
}

}  // namespace standoff
