// SPDX-License-Identifier: Apache-2.0
// Between the colors of files and linear light, in which colors are added.
#pragma once

#include "render/float3.h"
#include "standoff/color.h"

namespace standoff {

Float3 linear_of(Color color);
/// Components outside [0, 1] count as the nearer end.
Color color_of_light(Float3 linear);

}  // namespace standoff
