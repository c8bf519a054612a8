// SPDX-License-Identifier: Apache-2.0
// Poses go to the device in pieces, but those that a sphere and a box alone tell free. What it leaves undecided the CPU
// decides.
#include "collision/collide_on_device.h"

#include <algorithm>

#include "collision/batch.h"
#include "collision/collide.h"
#include "collision/query_pair.h"

namespace standoff::collision {
namespace {

// Poses at a time: enough to fill any GPU, at some 150 bytes each.
constexpr std::size_t kPiece = std::size_t{1} << 18;

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

std::vector<CollisionResult> collide_on_device(const DeviceRow& row, const CollisionModel& a, const Pose& pose_a,
                                               const CollisionModel& b, std::span<const Pose> poses_b, double margin,
                                               const Execution& execution, BatchReport& report, int stack) {
  std::vector<CollisionResult> results(poses_b.size());
  const Kernels& kernels = kernels_for(execution.simd, "collide");
  const QueryPair bodies(a, pose_a, b, {}, kernels);  // which of them gives its field does not depend on poses
  for (std::size_t first = 0; first < poses_b.size(); first += kPiece) {
    const auto poses = poses_b.subspan(first, std::min(kPiece, poses_b.size() - first));
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

}  // namespace standoff::collision
