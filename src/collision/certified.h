// SPDX-License-Identifier: Apache-2.0
// What the target's distance field alone can decide.
#pragma once

#include "collision/query_pair.h"

namespace standoff::collision {

/// free, hit (only where the margin is positive) or ambiguous.
Verdict certify(const QueryPair& pair, double margin);

}  // namespace standoff::collision
