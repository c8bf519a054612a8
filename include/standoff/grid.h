// Regular grids of samples, and helpers that fit them to meshes.
#pragma once

#include <cstdint>

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
void validate(const Grid& grid);

/// Samples along the longest side when nothing else is said.
inline constexpr std::int64_t kDefaultSamples = 256;

/// Cubic cells, `samples` on the longest side of `box` grown by `padding` (world units) on all sides. The other sides
/// get as many samples as cover the box; the grid is centred on it. A box without extent gets spacing 1.
/// Errors: usage when the box is empty, samples < 2, or padding is negative or not finite.
Grid fit_samples(const Box& box, std::int64_t samples = kDefaultSamples, double padding = 0);

/// Cells of the given size, as many as cover `box` grown by `padding`, centred on it. Errors: usage as above.
Grid fit_spacing(const Box& box, Vec3 spacing, double padding = 0);

/// The given number of samples per axis, the outermost ones on the faces of `box` grown by `padding`, so that the
/// spacing may differ per axis. An axis without extent, or with one sample, gets the largest spacing of the others (or
/// 1). Errors: usage as above.
Grid fit_size(const Box& box, Size3 size, double padding = 0);

}  // namespace standoff
