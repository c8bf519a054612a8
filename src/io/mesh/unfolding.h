// SPDX-License-Identifier: Apache-2.0
// Scenes that place their meshes many times.
#pragma once

#include <cstdint>

#include "files/file_view.h"

namespace standoff {

/// What a scene becomes once each of its nodes has a copy of its mesh. Doubles: files can ask for more than 64 bits
/// count.
struct Unfolded {
  double vertices = 0, triangles = 0;
  double corners = 0;  ///< of the longest list of corners, which is held while its triangles are made
};

/// A few bytes of a file can ask for more memory than there is: before any copy is made, throws Error{limit} where they
/// would take more than 192 MiB and twelve times the `bytes` of the file and of those that were read with it.
void check_unfolded(const FileView& file, const Unfolded& unfolded, std::uint64_t bytes);

}  // namespace standoff
