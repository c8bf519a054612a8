// SPDX-License-Identifier: Apache-2.0
// Compares an answer of standoff with a peer's. Each answer is a number.
#pragma once

#include "collision_contest.h"

namespace standoff::bench {

/// The answer of a free sweep: later than any time.
inline constexpr double kFree = 2;

/// An answer is 0 or 1 for collide, the number of contacts, the distance, or the time of a sweep.
bool is_hit(Query query, double answer);

/// For all queries but sweeps. The numbers of contacts may differ, as programs define a contact differently.
bool agree(Query query, double ours, double theirs);

/// A sweep ends anywhere within the tolerance, so times differ. Three things must hold: where ours ends, the peer finds
/// the bodies within the tolerance; at some places between its end and ours, it finds that they do not touch; and ours
/// is not free if the peer's is not.
bool agree_on_sweep(const CollisionPeer& peer, const RigidMotion& motion, double tolerance, double ours, double theirs);

}  // namespace standoff::bench
