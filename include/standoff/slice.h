// SPDX-License-Identifier: Apache-2.0
// Pictures of slices through a field.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "standoff/axis.h"
#include "standoff/colormap.h"
#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/field.h"

namespace standoff {

/// What a slice shows between samples.
enum class Interpolation {
  automatic,  ///< nearest if each sample is at least 12 pixels wide and high, else linear
  nearest,    ///< each sample is a square, or a rectangle if the spacings differ
  linear,     ///< values are linear between samples
};

struct SliceOptions {
  std::optional<Axis> axis;  ///< the axis the plane is perpendicular to; by default, see slice_plane()
  std::optional<double> at;  ///< position along the axis: 0 is the first sample, 1 the last; to the nearest one
  std::optional<std::int64_t> index;  ///< the sample along the axis, from 0; overrides `at`
  Colormap colormap = Colormap::automatic;
  Interpolation interpolation = Interpolation::automatic;
  Background background = Background::white;
  int pixels = 512;      ///< the plane's longer side is enlarged by a whole factor to at least this, 1 to 8192
  bool contours = true;  ///< lines at the legend's round numbers, except across squares
  bool bare = false;     ///< the plane alone: no words, legend, scales or margins
  /// Of a field that is a part of a larger one: what its first sample along the axis is there, and how many samples
  /// that one has. For the words of the picture.
  struct Part {
    std::int64_t first = 0, count = 0;
  };
  std::optional<Part> part;
  // In UTF-8, each at most 200 characters.
  std::string title;   ///< above the picture; by default none
  std::string unit;    ///< of lengths, behind the names of the scales
  std::string legend;  ///< what the numbers are, above the legend; by default "distance", with the unit
};

/// A plane of samples.
struct SlicePlane {
  Axis axis = Axis::z;     ///< the axis it is perpendicular to
  std::int64_t index = 0;  ///< the sample along that axis, from 0
  double position = 0;     ///< the same, world units
};

/// The plane that write_slice_png draws. What the options leave open is chosen so that the plane shows the most: it
/// cuts the longest outline out of the surface, where a surface that the plane only grazes counts little. Of planes
/// that show nearly as much (90 %), it is the one nearest to the middle of the surface; of axes that do (98 %), z
/// before y before x. Where no sample is near a surface, it is the middle plane. Takes one pass over the stored tiles.
/// Errors: usage (options out of range).
STANDOFF_API SlicePlane slice_plane(const DistanceField& field, const SliceOptions& options = {});

/// Draws the samples of a plane with a legend, scales in world units and contour lines, and writes a PNG picture, which
/// appears whole or not at all. The plane's first axis points right and its second up: x and y for axis z, x and z for
/// y, y and z for x; if the first one is the field's up axis (Provenance::up), the other way round. The colours span
/// the finite values of the plane; values clamped to the thickness, and infinite ones, are grey, darker inside; those
/// that are no numbers are pink. A field has a sign if its provenance says so or a value is negative: then a line is
/// drawn where the values, interpolated between samples, pass 0, and the colours of `diverging` span equally far to
/// both sides. Without a sign, Colormap::automatic draws the surface white, and its colours end where 95 % of the
/// samples do, unless the rest is hardly farther. Contour lines that would be nearer than eight pixels are left out. If
/// a side would have more than 8192 pixels, samples are left out. Takes memory for the plane and the picture; the field
/// stays sparse. Errors: usage (options out of range, or built without libpng), output.
STANDOFF_API void write_slice_png(const std::filesystem::path& path, const DistanceField& field,
                                  const SliceOptions& options = {}, Existing existing = Existing::replace);

}  // namespace standoff
