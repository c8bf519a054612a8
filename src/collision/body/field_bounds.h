// SPDX-License-Identifier: Apache-2.0
// Lower bounds of the distance to a surface, everywhere: a fine sparse field near it, a coarse one around it. If the
// surface is closed, also the sign: which samples are inside. It is stored apart, because distance bounds need none.
#pragma once

#include <cstdint>

#include "collision/body/field_view.h"
#include "core/memory.h"
#include "core/progress.h"
#include "standoff/execution.h"
#include "standoff/field.h"
#include "standoff/mesh.h"

namespace standoff::collision {

/// Half-width of the fine field's band, and the coarse field's spacing, in fine spacings. The band must reach past the
/// coarse field's error, sqrt(3)/2 * 4 spacings, so that the coarse bound is only used where it is the better one.
inline constexpr int kBandSamples = 4;
inline constexpr int kCoarseStep = 4;

/// Samples are stored in 255 steps of the band's half-width, rounded down: they stay lower bounds. Positions are
/// relative to the body's middle.
struct FieldBounds {
  double spacing = 1;
  Size3 size, coarse_size;
  Vec3 origin;
  Box box;                             ///< of the surface
  HugePageVector<std::int32_t> slots;  ///< per tile; tile 0 of the samples is all far
  HugePageVector<std::uint8_t> samples;
  HugePageVector<float> coarse;  ///< distances, rounded down; no clamping
  /// One bit per sample, set if its winding number is positive. In the order of `samples` and of `coarse`, the lowest
  /// bit of a byte first. Empty if the surface is not closed; the bits of tile 0 mean nothing.
  HugePageVector<std::uint8_t> inside, coarse_inside;

  bool has_sign() const { return !inside.empty(); }
  double thickness() const { return kBandSamples * spacing; }
  FieldView view() const;
};

/// The spacing for a mesh when none is asked for: about 12 million samples in its box, but never less than a
/// quarter of its mean edge, below which a finer field gives no better bound.
double default_spacing(MeshView mesh, const Box& box);

/// The fields' grids for a mesh of that box, without samples. Errors: limit.
FieldBounds plan_field_bounds(const Box& box, double spacing);

/// Builds the fields through compute(); they have a sign if the mesh is closed and consistently oriented. Errors:
/// limit.
FieldBounds build_field_bounds(MeshView mesh, Vec3 middle, double spacing, const Execution& execution,
                               ProgressMeter& progress);

}  // namespace standoff::collision
