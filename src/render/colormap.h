// SPDX-License-Identifier: Apache-2.0
// Colors for numbers.
#pragma once

#include "render/image.h"
#include "standoff/colormap.h"

namespace standoff {

/// The color of `t` in [0, 1]; values outside count as the nearer end. `automatic` counts as viridis: a number has no
/// sign.
Color color_of(Colormap map, double t);

}  // namespace standoff
