// What must hold of a glTF file before assimp may see it.
#pragma once

#include "io/file_view.h"

namespace difi {

/// Errors: input, when the header of a binary glTF, the lengths of its chunks, the nesting of its JSON or a primitive
/// without corners would make a reader that trusts them take all memory, end the stack or the program.
void check_glb(const FileView& file);

/// The same for the JSON of a glTF that is text.
void check_gltf(const FileView& file);

}  // namespace difi
