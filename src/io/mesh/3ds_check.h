// SPDX-License-Identifier: Apache-2.0
// What must hold of a 3DS file before assimp may see it.
#pragma once

#include "files/file_view.h"

namespace standoff {

/// Errors: input, when the tracks of its animation claim more keys than there are bytes: assimp asks for their memory
/// first, up to 100 GB; when its nodes are nested too deep for assimp's stack, or there are
/// too many of them or of other parts.
void check_3ds(const FileView& file);

}  // namespace standoff
