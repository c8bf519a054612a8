// SPDX-License-Identifier: Apache-2.0
// Distances of many poses on a device, and which of its answers are certainly the CPU's.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "collision/close_pairs.h"
#include "collision/distance.h"
#include "collision/gap_proof.h"

namespace standoff::collision {
namespace {

// The poses of a batch on the device: enough to fill any GPU, at some 350 bytes each.
constexpr std::size_t kDistancesAtOnce = std::size_t{1} << 16;

// Whether the CPU's search may end by a proof. Then it reports the pair that it had found, not the first of those that
// are equally near.
bool may_be_proved(const GapProof& proof, const DistanceAnswer& answer) {
  return proof.boxes_may_prove() || (answer.ties > kWorthAProof && proof.corners_may_prove());
}

// The result, if it is certainly the CPU's. The points are computed by the CPU's kernels.
std::optional<DistanceResult> result_of(const QueryPair& pair, const DistanceAnswer& answer, double limit) {
  if (answer.verdict != DeviceVerdict::free) return {};
  if (answer.of_target == kNoTriangle) return beyond(limit);
  PairBatch batch(pair);
  batch.add(answer.of_target, answer.of_probe);
  std::optional<DistanceResult> result;
  batch.measure([&](std::uint32_t of_target, std::uint32_t of_probe, double distance_sq, Vec3 of_p, Vec3 of_q) {
    const double distance = std::sqrt(distance_sq);
    if (!may_be_proved({pair, of_p, of_q, distance}, answer))
      result = result_of(pair, NearestPair{of_target, of_probe, of_p, of_q}, distance, distance);
  });
  return result;
}

}  // namespace

DistanceQuery query_of(const QueryPair& pair) {
  const Pose& of_b = pair.swapped ? pair.target.pose : pair.probe.pose;
  return {transform_of(of_b), transform_of(pair.relative), pair.transform, pair.pose_slack};
}

std::vector<DistanceResult> distance_on_device(const DeviceRow& row, const Body& a, const Pose& pose_a, const Body& b,
                                               std::span<const Pose> poses_b, double limit, const Execution& execution,
                                               BatchReport& report, const DistanceLists& lists) {
  std::vector<DistanceResult> results;
  results.reserve(poses_b.size());
  const Kernels& kernels = kernels_for(execution.simd, "distance");
  const QueryPair bodies(a, pose_a, b, {}, kernels);  // which body is the target does not depend on poses
  for (std::size_t first = 0; first < poses_b.size(); first += kDistancesAtOnce) {
    const auto poses = poses_b.subspan(first, std::min(kDistancesAtOnce, poses_b.size() - first));
    const auto queries = for_each<DistanceQuery>(poses.size(), execution.threads, [&](std::size_t n) {
      return query_of(QueryPair(a, pose_a, b, poses[n], kernels));
    });
    std::vector<DistanceAnswer> answers(poses.size());
    row.distance({.target = *bodies.target.body,
                  .probe = *bodies.probe.body,
                  .target_is_b = bodies.swapped,
                  .probe_is_small = bodies.probe_is_small(),
                  .of_a = transform_of(pose_a),
                  .limit = limit,
                  .queries = queries,
                  .answers = answers,
                  .device = execution.device,
                  .lists = lists});
    const auto found = for_each<std::optional<DistanceResult>>(poses.size(), execution.threads, [&](std::size_t n) {
      return result_of(QueryPair(a, pose_a, b, poses[n], kernels), answers[n], limit);
    });
    const auto all = for_each<DistanceResult>(poses.size(), execution.threads, [&](std::size_t n) {
      DistanceState none;
      return found[n] ? *found[n] : distance_exactly(a, pose_a, b, poses[n], {.limit = limit}, kernels, none);
    });
    results.insert(results.end(), all.begin(), all.end());
    for (std::size_t n = 0; n < poses.size(); ++n) {
      const bool overflowed = answers[n].verdict == DeviceVerdict::overflow;
      report.on_device += found[n].has_value();
      report.undecided += !found[n] && !overflowed;
      report.overflowed += overflowed;
    }
  }
  return results;
}

}  // namespace standoff::collision
