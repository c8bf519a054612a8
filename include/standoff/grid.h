// SPDX-License-Identifier: Apache-2.0
// Regular grids of samples, and helpers that fit them to meshes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "standoff/export.h"
#include "standoff/vec.h"

namespace standoff {

/// Sample (i,j,k), 0 <= i < size.x and so on, is at origin + spacing * (first + (i,j,k)). x varies fastest in memory.
/// A grid may be a window of a larger one: then it has that one's origin, and `first` says where it begins, so that its
/// samples have the coordinates that they have there, bit for bit.
struct Grid {
  Size3 size;                ///< samples per axis, each at least 1
  Vec3 origin;               ///< position of sample (0,0,0) of the whole grid, world units
  Vec3 spacing = {1, 1, 1};  ///< distance between neighbouring samples per axis, world units, positive
  Size3 first = {};          ///< the sample of the whole grid that is sample (0,0,0) here, from 0

  friend bool operator==(const Grid&, const Grid&) = default;
  constexpr Vec3 position(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return origin + spacing * Vec3{double(first.x + i), double(first.y + j), double(first.z + k)};
  }
  /// The position of sample (0,0,0).
  constexpr Vec3 corner() const { return position(0, 0, 0); }
  /// The samples from `from` on, as many as `count`. Requires that they are samples of this grid.
  constexpr Grid window(const Size3& from, const Size3& count) const {
    return {count, origin, spacing, {first.x + from.x, first.y + from.y, first.z + from.z}};
  }
  /// The index of sample (i,j,k) in a dense array, x fastest. Requires a valid grid and a sample of it.
  constexpr std::int64_t index(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return i + size.x * (j + size.y * k);
  }
  constexpr std::int64_t sample_count() const { return size.count(); }
  /// The box whose corners are the first and the last sample. Requires a size of at least 1 per axis.
  Box bounds() const { return {corner(), position(size.x - 1, size.y - 1, size.z - 1)}; }
  /// The largest of the three spacings.
  double max_spacing() const { return std::max({spacing.x, spacing.y, spacing.z}); }
};

/// Throws Error{usage} unless sizes and spacings are positive, and spacings, origin and extent are finite. Throws
/// Error{limit} if a side has more than 2^40 samples or the grid more than 2^62. The helpers below validate their
/// grids.
STANDOFF_API void validate(const Grid& grid);

/// The thickness of a full field, in which no value is clamped. A full field is the most expensive one.
inline constexpr double kFullField = std::numeric_limits<double>::infinity();

/// The default number of samples along the longest side.
inline constexpr std::int64_t kDefaultResolution = 256;

/// The most of the box's longest side that a band's padding takes on each side: a wider band is not followed farther,
/// because it would leave few samples for the mesh.
inline constexpr double kMostPadding = 0.1;

/// How far a grid reaches beyond the box it is fitted to, on each side of each axis:
/// max(least_samples, min(max(length, samples), most_share * the box's longest side)).
struct Padding {
  double length = 0;         ///< world units
  double samples = 0;        ///< in units of the grid's spacing
  double least_samples = 2;  ///< so that slices and isosurfaces do not end at the grid's faces; less in tiny grids
  double most_share = std::numeric_limits<double>::infinity();  ///< if finite, may cut off a wide band
};

/// The padding for a band: its thickness (world units), at most kMostPadding of the longest side, at least two samples.
/// The padding for a full field: two samples. Errors: usage unless the thickness is positive.
STANDOFF_API Padding padding_for(double thickness);
/// The same for a band whose half-width is given in samples.
STANDOFF_API Padding padding_for_samples(double samples);

/// A grid of equal spacings with `resolution` samples on the longest side of the padded box, centred on the box. The
/// other sides get as many samples as cover the padded box. A box without extent gets spacing 1 if the padding has no
/// length, and one sample if there is no padding. Errors: usage (an empty box; resolution < 2; a member of the padding
/// that is negative or not a number; a padding that leaves no samples for the box), limit (more than 2^40 samples on a
/// side).
STANDOFF_API Grid fit_resolution(const Box& box, std::int64_t resolution, const Padding& padding);
/// The same with padding_for(thickness). `thickness` is the thickness of the field that will be computed.
inline Grid fit_resolution(const Box& box, std::int64_t resolution = kDefaultResolution,
                           double thickness = kFullField) {
  return fit_resolution(box, resolution, padding_for(thickness));
}

/// A grid of the given spacings, with as many samples as cover the padded box, centred on the box. Errors: as above.
STANDOFF_API Grid fit_spacing(const Box& box, Vec3 spacing, const Padding& padding);
/// The same with padding_for(thickness).
inline Grid fit_spacing(const Box& box, Vec3 spacing, double thickness = kFullField) {
  return fit_spacing(box, spacing, padding_for(thickness));
}

/// A grid of the given number of samples per axis. The outermost samples are on the faces of the padded box, so the
/// spacing may differ per axis. An axis without extent, or with one sample, gets the largest spacing of the others (or
/// 1 if there is none). Errors: as above.
STANDOFF_API Grid fit_size(const Box& box, Size3 size, const Padding& padding);
/// The same with padding_for(thickness).
inline Grid fit_size(const Box& box, Size3 size, double thickness = kFullField) {
  return fit_size(box, size, padding_for(thickness));
}

}  // namespace standoff
