// Colors for numbers.
#pragma once

#include "difi/slice.h"
#include "render/image.h"

namespace difi {

/// The color of `t` in [0, 1]; values outside count as the nearer end.
Color color_of(Colormap map, double t);

}  // namespace difi
