// SPDX-License-Identifier: Apache-2.0
#include "render/slice_texture.h"

#include <algorithm>

#include "render/band_edge.h"

namespace standoff {
namespace {

// Between two neighbouring samples of a row.
struct Neighbours {
  std::int64_t first, second;
  float share;

  Neighbours(float at, std::int64_t count) {
    const float inside = std::clamp(at, 0.0F, static_cast<float>(count - 1));
    first = std::min(static_cast<std::int64_t>(inside), std::max<std::int64_t>(count - 2, 0));
    second = std::min(first + 1, count - 1);
    share = inside - static_cast<float>(first);
  }
  // Exact at samples, also beside infinite ones.
  float mix(float a, float b) const { return share == 0 ? a : a + (b - a) * share; }
};

}  // namespace

SliceTexture::SliceTexture(const DistanceField& field, const SliceOptions& where)
    : plane_(plane_of(field, where)),
      extended_(beyond_band(plane_, static_cast<float>(field.thickness()))),
      thickness_(static_cast<float>(field.thickness())) {}

SliceTexture::Values SliceTexture::at(float right, float up) const {
  const Neighbours r(right, plane_.width), u(up, plane_.height);
  const auto between = [&](const Plane& plane) {
    return u.mix(r.mix(plane.value(r.first, u.first), plane.value(r.second, u.first)),
                 r.mix(plane.value(r.first, u.second), plane.value(r.second, u.second)));
  };
  return {between(plane_), between(extended_)};
}

}  // namespace standoff
