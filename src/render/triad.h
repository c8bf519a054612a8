// SPDX-License-Identifier: Apache-2.0
// Three small arrows: where x, y and z point.
#pragma once

#include "render/camera.h"
#include "render/image.h"
#include "render/theme.h"

namespace standoff {

/// In the lower left corner, `margin` pixels from the picture's edges; all as large as `scale` says.
void draw_triad(Image& image, const Camera& camera, const Theme& theme, int margin, double scale);

}  // namespace standoff
