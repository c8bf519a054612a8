// SPDX-License-Identifier: Apache-2.0
// Regular grids of samples, and helpers that fit them to meshes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "standoff/export.h"
#include "standoff/vec.h"

namespace standoff {

/// Sample (i,j,k), 0 <= i < size.x and so on, sits at origin + spacing * (i,j,k). x varies fastest in memory.
struct Grid {
  Size3 size;                ///< samples per axis, each at least 1
  Vec3 origin;               ///< position of sample (0,0,0), world units
  Vec3 spacing = {1, 1, 1};  ///< distance between neighbouring samples per axis, world units, positive

  friend bool operator==(const Grid&, const Grid&) = default;
  Vec3 position(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return origin + spacing * Vec3{double(i), double(j), double(k)};
  }
  /// Requires a valid grid, and a sample of it.
  std::int64_t index(std::int64_t i, std::int64_t j, std::int64_t k) const { return i + size.x * (j + size.y * k); }
  std::int64_t sample_count() const { return size.count(); }
  /// The box whose corners are the first and the last sample. Requires sides of at least 1.
  Box bounds() const { return {origin, position(size.x - 1, size.y - 1, size.z - 1)}; }
  /// The largest of the three spacings.
  double max_spacing() const { return std::max({spacing.x, spacing.y, spacing.z}); }
};

/// Throws Error{usage} unless sizes and spacings are positive, spacings, origin and extent finite, and Error{limit}
/// where a side is of more than 2^40 samples or all of them are more than 2^62. The helpers below check their grids so.
STANDOFF_API void validate(const Grid& grid);

/// The thickness of a full field, in which every sample is a distance: the dearest field there is.
inline constexpr double kFullField = std::numeric_limits<double>::infinity();

/// Samples along the longest side when nothing else is said.
inline constexpr std::int64_t kDefaultSamples = 256;

/// How far a grid reaches beyond the box it is fitted to, on each side of each axis:
/// max(least_samples, min(max(length, samples), most_share * the box's longest side)).
struct Padding {
  double length = 0;         ///< world units
  double samples = 0;        ///< samples of the grid itself
  double least_samples = 2;  ///< where the grid has so many: for slices and surfaces that do not end at its faces
  double most_share = std::numeric_limits<double>::infinity();  ///< a wider band is cut off
};

/// The padding that a band wants: its thickness (world units), so that no sample nearer than the thickness is left out,
/// and at least two samples. A full field (infinite) gets two samples. Errors: usage unless the thickness is positive.
STANDOFF_API Padding padding_for(double thickness);

/// Cubic cells, `samples` on the longest side of the padded box. The other sides get as many samples as cover it; the
/// grid is centred on it. A box without extent gets spacing 1 where the padding has no length, and one sample without
/// padding.
/// Errors: usage when the box is empty, samples < 2, a member of the padding is negative or no number, or nothing is
/// left for the box; limit when it takes more than 2^40 samples on a side.
STANDOFF_API Grid fit_samples(const Box& box, std::int64_t samples, const Padding& padding);
/// The same with padding_for(thickness): give the thickness of the field that is to be computed.
inline Grid fit_samples(const Box& box, std::int64_t samples = kDefaultSamples, double thickness = kFullField) {
  return fit_samples(box, samples, padding_for(thickness));
}

/// Cells of the given size, as many as cover the padded box, centred on it. Errors: as above.
STANDOFF_API Grid fit_spacing(const Box& box, Vec3 spacing, const Padding& padding);
/// The same with padding_for(thickness).
inline Grid fit_spacing(const Box& box, Vec3 spacing, double thickness = kFullField) {
  return fit_spacing(box, spacing, padding_for(thickness));
}

/// The given number of samples per axis, the outermost ones on the faces of the padded box, so that the spacing may
/// differ per axis. An axis without extent, or with one sample, gets the largest spacing of the others (or 1).
/// Errors: as above.
STANDOFF_API Grid fit_size(const Box& box, Size3 size, const Padding& padding);
/// The same with padding_for(thickness).
inline Grid fit_size(const Box& box, Size3 size, double thickness = kFullField) {
  return fit_size(box, size, padding_for(thickness));
}

}  // namespace standoff
