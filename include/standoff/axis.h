// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace standoff {

/// One of the three axes of the world and of every grid.
enum class Axis { x, y, z };

/// 'x', 'y' or 'z'.
constexpr char name_of(Axis axis) { return static_cast<char>('x' + static_cast<int>(axis)); }

}  // namespace standoff
