// SPDX-License-Identifier: Apache-2.0
// What must hold of a COLLADA file before assimp may see it.
#pragma once

#include "files/file_view.h"

namespace standoff {

/// Assimp trusts the counts and indices of COLLADA: wrong ones make it read past the ends of its arrays, take all
/// memory or leave triangles out. Errors: input, with the line, when the numbers of a primitive do not fit its count,
/// an accessor reaches past its array, nodes instance themselves, elements are nested too deep, or there are too many.
void check_collada(const FileView& file);

}  // namespace standoff
