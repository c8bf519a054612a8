// SPDX-License-Identifier: Apache-2.0
#include "agreement.h"

#include <cmath>

namespace standoff::bench {

bool is_hit(Query query, double answer) {
  return query == Query::distance ? answer == 0 : query == Query::sweep ? answer <= 1 : answer > 0;
}

bool agree(Query query, double ours, double theirs) {
  if (query == Query::distance) return std::abs(ours - theirs) <= 1e-6 * (1 + theirs);
  return is_hit(query, ours) == is_hit(query, theirs);
}

bool agree_on_sweep(const CollisionPeer& peer, const RigidMotion& motion, double tolerance, double ours,
                    double theirs) {
  constexpr int kLooks = 8;
  if (ours > 1) return theirs > 1;
  if (peer.distance(pose_at(motion, ours)) > tolerance * (1 + 1e-6)) return false;
  for (int look = 0; look < kLooks && ours > theirs; ++look)
    if (peer.collide(pose_at(motion, theirs + (ours - theirs) * look / kLooks))) return false;
  return true;
}

}  // namespace standoff::bench
