// SPDX-License-Identifier: Apache-2.0
// A sheet as a solid: the distance to it, less half of the solid's thickness. The one sign that changes magnitudes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "core/progress.h"
#include "standoff/field.h"
#include "standoff/sign.h"

namespace standoff {

/// What becomes of distances from the mesh. World units.
class Shell {
 public:
  /// `thickness`: the field's. Requires SignMethod::shell and valid options.
  Shell(const SignOptions& options, double thickness)
      : half_(options.shell / 2),
        thickness_(thickness),
        reach_(static_cast<float>(thickness + half_)),
        invert_(options.invert) {}

  /// How far distances must be known: those of the field's band, on both sides of the solid's surface.
  static double reach(double shell, double thickness) { return thickness + shell / 2; }

  /// The field's value at a sample whose distance, at most the reach, was rounded to float. One more rounding.
  float value(float distance) const {
    const double outwards = distance < reach_ ? distance - half_ : thickness_;
    return static_cast<float>(std::clamp(invert_ ? 0 - outwards : outwards, -thickness_, thickness_));
  }
  /// Whether a distance below the reach is that of no band sample, because it is deep inside the solid.
  bool is_deep(float distance) const { return distance - half_ < -thickness_; }
  bool inverts() const { return invert_; }

 private:
  double half_, thickness_;
  float reach_;  // what a backend writes where the distance is larger
  bool invert_;
};

/// Changes a field of thickness t that was filled with distances up to Shell::reach. Tiles that are left without a band
/// sample are no longer stored. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
void apply(const Shell& shell, DistanceField& field, ProgressMeter& progress);
/// The same for one value per sample; `nearest` may be empty.
void apply(const Shell& shell, std::span<float> values, std::span<std::uint32_t> nearest, ProgressMeter& progress);

}  // namespace standoff
