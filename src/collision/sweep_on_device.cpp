// SPDX-License-Identifier: Apache-2.0
// Motions go to the device in pieces. What is not certainly free the CPU sweeps from the beginning: begun later its
// steps would be others, and with them the time of a hit, and whether a pass within the tolerance counts as one.
#include "collision/sweep_on_device.h"

#include <algorithm>

#include "collision/batch.h"
#include "collision/sweep.h"
#include "collision/sweep_rounding.h"

namespace standoff::collision {
namespace {

// Motions at a time: enough to fill any GPU, at some 200 bytes each.
constexpr std::size_t kPiece = std::size_t{1} << 17;

struct PreparedMotion {
  SweepQuery query;
  bool jumps;  ///< the last pose must be looked at
};

// The CPU sweeps all motions but those that are free and whose last pose does not jump.
bool decided(const PreparedMotion& motion, const SweepAnswer& answer) {
  return answer.verdict == DeviceVerdict::free && !motion.jumps;
}

}  // namespace

std::vector<SweepResult> sweep_on_device(const DeviceRow& row, const CollisionModel& a, const Pose& pose_a,
                                         const CollisionModel& b, std::span<const RigidMotion> motions,
                                         double tolerance, const Execution& execution, BatchReport& report, int stack) {
  std::vector<SweepResult> results;
  results.reserve(motions.size());
  const Kernels& kernels = kernels_for(execution.simd, "sweep");
  const QueryPair bodies(a, pose_a, b, {}, kernels);  // which of them gives its field does not depend on motions
  for (std::size_t first = 0; first < motions.size(); first += kPiece) {
    const auto piece = motions.subspan(first, std::min(kPiece, motions.size() - first));
    const auto prepared = for_each<PreparedMotion>(piece.size(), execution.threads, [&](std::size_t n) {
      const AxisAngleMotion path(piece[n]);
      const QueryPair pair(a, pose_a, b, piece[n].from, kernels);
      const double kept = tolerance_kept(pair, path, tolerance);
      return PreparedMotion{{relative_motion(pair, path), distance_kept(pair, path, kept)},
                            last_pose_may_jump(path, b, kept)};
    });
    std::vector<SweepQuery> queries;
    queries.reserve(prepared.size());
    for (const PreparedMotion& one : prepared) queries.push_back(one.query);
    std::vector<SweepAnswer> answers(piece.size());
    row.sweep({.target = *bodies.target.body,
               .probe = *bodies.probe.body,
               .queries = queries,
               .answers = answers,
               .device = execution.device,
               .stack = stack});
    const auto found = for_each<SweepResult>(piece.size(), execution.threads, [&](std::size_t n) {
      return decided(prepared[n], answers[n]) ? SweepResult{}
                                              : sweep_exactly(a, pose_a, b, piece[n], tolerance, kernels);
    });
    results.insert(results.end(), found.begin(), found.end());
    for (std::size_t n = 0; n < answers.size(); ++n) {
      const bool overflowed = answers[n].verdict == DeviceVerdict::overflow;
      report.on_device += decided(prepared[n], answers[n]);
      report.undecided += !overflowed && !decided(prepared[n], answers[n]);
      report.overflowed += overflowed;
    }
  }
  return results;
}

}  // namespace standoff::collision
