// SPDX-License-Identifier: Apache-2.0
// Do standoff and a peer give the same answer? Each answer is a number.
#pragma once

#include "collision_contest.h"

namespace standoff::bench {

/// A sweep's answer where it is free: later than any time.
inline constexpr double kFree = 2;

/// Of collide 0 or 1, of contacts their number, of distance that, of a sweep its time.
bool is_hit(Query query, double answer);

/// For all queries but sweeps. How many contacts there are may differ: what counts as one does.
bool agree(Query query, double ours, double theirs);

/// A sweep ends anywhere within the tolerance, so times differ. What must hold: where ours ends the peer finds the
/// bodies within the tolerance; at some places between its end and ours it finds none that touch; ours is not free
/// where the peer's is not.
bool agree_on_sweep(const CollisionPeer& peer, const RigidMotion& motion, double tolerance, double ours, double theirs);

/// The pose at a time of a motion that does not turn.
Pose on_the_way(const RigidMotion& motion, double t);

}  // namespace standoff::bench
