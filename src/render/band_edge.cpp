// SPDX-License-Identifier: Apache-2.0
#include "render/band_edge.h"

#include <algorithm>
#include <cmath>

namespace standoff {
namespace {

// Where only a diagonal neighbour is in the band, so much of a spacing beyond it: on its far side in any case.
constexpr double kDiagonal = 0.5;

class Extension {
 public:
  Extension(const Plane& plane, float thickness) : plane_(plane), thickness_(thickness) {}

  float value(std::int64_t r, std::int64_t u) const {
    const float clamped = plane_.value(r, u);
    if (!(std::abs(clamped) >= thickness_) || !std::isfinite(clamped)) return clamped;
    const float sign = clamped < 0 ? -1.0f : 1.0f;
    double least = kNone;
    for (const std::int64_t step : {-1, 1}) {
      least = std::min(least, guess(r + step, u, r + 2 * step, u, plane_.step_right, sign));
      least = std::min(least, guess(r, u + step, r, u + 2 * step, plane_.step_up, sign));
    }
    if (least == kNone && any_diagonal(r, u, sign))
      least = thickness_ + kDiagonal * std::min(plane_.step_right, plane_.step_up);
    return least == kNone ? clamped : sign * std::max(thickness_, static_cast<float>(least));
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  bool in_band(std::int64_t r, std::int64_t u, float sign) const {
    if (r < 0 || u < 0 || r >= plane_.width || u >= plane_.height) return false;
    const float value = sign * plane_.value(r, u);
    return value < thickness_ && value > -thickness_;
  }
  bool any_diagonal(std::int64_t r, std::int64_t u, float sign) const {
    return in_band(r - 1, u - 1, sign) || in_band(r + 1, u - 1, sign) || in_band(r - 1, u + 1, sign) ||
           in_band(r + 1, u + 1, sign);
  }
  // From the neighbour, and the sample behind it where that too is in the band; distances rise by no more than the way.
  double guess(std::int64_t r1, std::int64_t u1, std::int64_t r2, std::int64_t u2, double way, float sign) const {
    if (!in_band(r1, u1, sign)) return kNone;
    const double near = sign * plane_.value(r1, u1);
    const double rise = in_band(r2, u2, sign) ? near - sign * plane_.value(r2, u2) : way;
    return near + std::clamp(rise, 0.0, way);
  }

  const Plane& plane_;
  float thickness_;
};

}  // namespace

Plane beyond_band(const Plane& plane, float thickness) {
  Plane extended = plane;
  const Extension extension(plane, thickness);
  auto out = extended.values.begin();
  for (std::int64_t u = 0; u < plane.height; ++u)
    for (std::int64_t r = 0; r < plane.width; ++r) *out++ = extension.value(r, u);
  return extended;
}

}  // namespace standoff
