// SPDX-License-Identifier: Apache-2.0
// The picture of a plane, before it becomes a file.
#pragma once

#include "render/image.h"
#include "render/plane.h"

namespace standoff {

struct SlicePicture {
  Image image;
  int left = 0, top = 0, width = 0, height = 0;  ///< where the plane's samples are, pixels
};

/// As write_slice_png says.
SlicePicture draw_slice(const DistanceField& field, const SliceOptions& options);

}  // namespace standoff
