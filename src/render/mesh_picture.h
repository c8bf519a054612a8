// The picture of a mesh, before it becomes a file.
#pragma once

#include "difi/picture.h"
#include "render/image.h"

namespace difi {

/// As write_mesh_png says.
Image draw_mesh(MeshView mesh, const PictureOptions& options);

}  // namespace difi
