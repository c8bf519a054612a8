// SPDX-License-Identifier: Apache-2.0
// How many things a 3DS file may hold.
#pragma once

#include "files/file_view.h"

namespace standoff {

/// Of a few bytes assimp makes kilobytes: nine of a material, three of a mesh, two of a light or a camera. It also
/// looks for each light and camera among all, and for the material of each group of faces. Errors: input, with the
/// byte, for more of them than memory and time should go into.
void check_3ds_parts(const FileView& file);

}  // namespace standoff
