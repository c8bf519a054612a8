#pragma once

namespace difi {

/// One of the three axes of the world and of every grid.
enum class Axis { x, y, z };

}  // namespace difi
