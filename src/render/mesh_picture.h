// SPDX-License-Identifier: Apache-2.0
// The picture of a mesh, before it becomes a file.
#pragma once

#include "render/image.h"
#include "standoff/picture.h"

namespace standoff {

/// As write_mesh_png says.
Image draw_mesh(MeshView mesh, const PictureOptions& options);

}  // namespace standoff
