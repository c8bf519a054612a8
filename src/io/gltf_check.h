// What must hold of a glTF file before assimp may see it.
#pragma once

#include "io/file_view.h"

namespace difi {

/// Errors: input, when the header of a binary glTF, the lengths of its chunks or the nesting of its JSON would make a
/// reader that trusts them take all memory or end the stack.
void check_glb(const FileView& file);

/// The same for the nesting of a glTF that is text.
void check_gltf(const FileView& file);

}  // namespace difi
