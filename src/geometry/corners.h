// SPDX-License-Identifier: Apache-2.0
// The corners of one triangle.
#pragma once

#include <array>

#include "standoff/vec.h"

namespace standoff {

using Corners = std::array<Vec3, 3>;

}  // namespace standoff
