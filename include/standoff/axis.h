// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace standoff {

/// One of the three axes of the world and of every grid.
enum class Axis { x, y, z };

}  // namespace standoff
