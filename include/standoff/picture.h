// SPDX-License-Identifier: Apache-2.0
// Pictures of meshes.
#pragma once

#include <filesystem>

#include "standoff/axis.h"
#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/mesh.h"

namespace standoff {

/// Size and viewpoint of a picture. It always shows the whole mesh.
struct PictureOptions {
  int width = 1280;           ///< pixels, 16 to 8192
  int height = 960;           ///< pixels, 16 to 8192
  double azimuth_deg = 35;    ///< the eye's angle about the up axis; 0: it looks along +y (z up) or -z (y up)
  double elevation_deg = 25;  ///< the eye's height above the horizon, -90 to 90
  bool perspective = true;    ///< false: parallel rays
  Axis up = Axis::z;
};

/// Draws a mesh with flat shading, the same for both sides of a triangle, and writes a PNG picture, which appears whole
/// or not at all. Takes about 30 bytes per vertex and 32 per pixel.
/// Errors: input (mesh), usage (options, or built without libpng), output.
STANDOFF_API void write_mesh_png(const std::filesystem::path& path, MeshView mesh, const PictureOptions& options = {},
                                 Existing existing = Existing::replace);

}  // namespace standoff
