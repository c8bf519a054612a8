// SPDX-License-Identifier: Apache-2.0
// Pictures of slices through a field.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "standoff/axis.h"
#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/field.h"

namespace standoff {

enum class Colormap {
  viridis,    ///< from dark blue (least) over green to yellow (greatest): visually uniform, readable in grey
  thesis,     ///< from red (least) over green to blue (greatest), as the 2008 thesis draws its slices
  diverging,  ///< blue inside, white at 0, red outside; equal distances are equally dark on both sides
  automatic,  ///< diverging if the field has a sign, else viridis
};

struct SliceOptions {
  Axis axis = Axis::z;  ///< the axis the plane is perpendicular to
  double at = 0.5;      ///< position along the axis: 0 is the first sample, 1 the last; rounded to the nearest sample
  std::optional<std::int64_t> index;  ///< the sample along the axis, from 0; overrides `at`
  Colormap colormap = Colormap::automatic;
  int pixels = 512;  ///< the plane's longer side is enlarged by a whole factor to at least this, 1 to 8192
};

/// Draws the samples of a plane with a legend, and writes a PNG picture, which appears whole or not at all. Samples are
/// squares (rectangles if the spacings differ). The plane's first axis points right and its second up: x and y for axis
/// z, x and z for y, y and z for x. The colours span the finite values of the plane; infinite values are grey. A
/// field has a sign if its provenance says so or a value is negative: then a line is drawn where the values,
/// interpolated between samples, pass 0, and the colours of `diverging` span equally far to both sides. If a side
/// would have more than 8192 pixels, samples are left out.
/// Errors: usage (options out of range, or built without libpng), output.
STANDOFF_API void write_slice_png(const std::filesystem::path& path, const DistanceField& field,
                                  const SliceOptions& options = {}, Existing existing = Existing::replace);

}  // namespace standoff
