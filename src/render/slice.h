// SPDX-License-Identifier: Apache-2.0
// Slices: the samples of a field in one plane, what lies between them, and the picture of them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/image.h"
#include "standoff/field.h"
#include "standoff/slice.h"

namespace standoff {

/// The samples of a field in one plane.
struct Plane {
  char normal = 'z', right = 'x', up = 'y';  ///< names of axes
  std::int64_t width = 0, height = 0;        ///< samples to the right and up
  double first_right = 0, first_up = 0;      ///< where the lower left sample is, world units
  double step_right = 1, step_up = 1;        ///< distances between samples, world units
  std::int64_t index = 0, count = 0;         ///< which sample along the normal, of how many
  double position = 0;                       ///< its coordinate, world units
  std::vector<float> values;                 ///< rightwards first, then upwards

  float value(std::int64_t r, std::int64_t u) const { return values[static_cast<std::size_t>(r + width * u)]; }
};

/// The samples of the plane that slice_plane() chooses. Errors: as there.
Plane plane_of(const DistanceField& field, const SliceOptions& options);

/// The plane with the axis `up` upwards, if that lies in it: such a plane is turned over its diagonal.
Plane upright(const Plane& plane, std::optional<Axis> up);

/// How much each plane of samples shows: for each axis, one number for each sample along it.
struct PlaneScores {
  std::array<std::vector<std::int64_t>, 3> along;
  std::array<double, 3> area{1, 1, 1};  ///< of one sample in the plane: along * area compares planes of different axes
};

/// A score is proportional to the length of the curve that the plane cuts out of the surface, weighted by the sine of
/// the angle between plane and surface: a face in the plane counts for nothing. Samples near the surface are counted,
/// each with the share of its gradient that lies in the plane.
PlaneScores plane_scores(const DistanceField& field);

/// The plane to show among those of one axis, or -1 where none shows anything: the nearest to the middle of those that
/// do among all that show 90 % of the most.
std::int64_t best_plane(const std::vector<std::int64_t>& scores);

/// The end of the colors for values without a sign, most of which would look alike if the few farthest had colors of
/// their own: the least value that 95 % do not exceed, where that is well below the greatest; else none.
std::optional<float> early_end(const std::vector<float>& values);

/// From where on, in world units, samples of an unsigned field count as its surface: values between samples on both
/// sides of it are hardly ever 0. 0 for fields with a sign.
float surface_level(const DistanceField& field);

/// The plane, with clamped values next to the band replaced by values extrapolated from the two samples before them. So
/// the level `thickness` of values interpolated between samples is where the band ends, as smooth as any other level;
/// between clamped values it would follow the squares of the samples.
Plane beyond_band(const Plane& plane, float thickness);

/// The plane's values at the centres of a picture's pixels, `width` by `height`, row by row from the top: linear
/// between samples, which are in the middle of their squares. The outermost half squares have the values of the
/// outermost samples.
std::vector<float> interpolated(const Plane& plane, int width, int height);

/// How much of each pixel a line covers that is `line_width` pixels wide, at most 2, and smooth, where `values` (as
/// interpolated() gives them) pass `level`; values equal to the level count as above it. Values that are not finite
/// have no line beside them.
std::vector<float> level_line(const std::vector<float>& values, int width, int height, double level, double line_width);

/// How much of each pixel lies where `values` are at least `level`, with a smooth edge; 0 where values are no numbers.
std::vector<float> share_above(const std::vector<float>& values, int width, int height, double level);

/// A plane of a field as a texture of a drawing: the values between its samples, and where the band ends.
class SliceTexture {
 public:
  SliceTexture(const DistanceField& field, const SliceOptions& where);

  const Plane& plane() const { return plane_; }
  float thickness() const { return thickness_; }
  float surface_level() const { return surface_level_; }

  struct Values {
    float value;  ///< linear between samples; not finite beside those that are not
    float edge;   ///< the same of beyond_band(): the band ends where its magnitude is the thickness
  };
  /// At a place counted in samples from the lower left one; the nearest one of the plane for places outside.
  Values at(float right, float up) const;

 private:
  Plane plane_, extended_;
  float thickness_, surface_level_;
};

/// The picture of a plane, before it becomes a file.
struct SlicePicture {
  Image image;
  int left = 0, top = 0, width = 0, height = 0;  ///< where the plane's samples are, pixels
};

/// As write_slice_png says.
SlicePicture draw_slice(const DistanceField& field, const SliceOptions& options);

}  // namespace standoff
