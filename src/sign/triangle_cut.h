// SPDX-License-Identifier: Apache-2.0
// How one triangle lies to another one, as far as it matters for what is on its two sides. Exact.
#pragma once

#include "geometry/corners.h"

namespace standoff {

enum class Meeting {
  apart,    ///< at most their borders touch: each triangle's two sides are the same all over, as far as these go
  cut,      ///< the other one is in the interior of at least one of them
  overlap,  ///< they lie in one plane, and have some area in common, but not all
  same,     ///< the same three corners
};

struct PairMeeting {
  Meeting kind = Meeting::apart;
  bool first_is_cut = false, second_is_cut = false;  ///< whether points of the other one are in the interior
};

/// Requires triangles with an area. May call a triangle cut that the other one touches at a point of the border, where
/// both pass through the other's plane; never the other way round.
PairMeeting meeting_of(const Corners& first, const Corners& second);

}  // namespace standoff
