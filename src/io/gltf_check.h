// What must hold of a glTF file before assimp may see it.
#pragma once

#include <cstddef>
#include <vector>

#include "io/file_view.h"

namespace difi {

/// Errors: input, when the header of a binary glTF, the lengths of its chunks, the nesting of its JSON or a primitive
/// without corners would make a reader that trusts them take all memory, end the stack or the program.
/// Returns the bytes that are to be replaced, each by a letter: the names of what is no shape and may end assimp as
/// well.
std::vector<std::size_t> check_glb(const FileView& file);

/// The same for the JSON of a glTF that is text.
std::vector<std::size_t> check_gltf(const FileView& file);

}  // namespace difi
