// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "surface/cells.h"
#include "surface/each_block.h"
#include "surface/hermite.h"

namespace standoff {
namespace {

using Offset = std::array<int, 3>;

// The difference of the values around a sample along an axis, per spacing: central where both neighbours are finite,
// else to one side.
double slope(const Neighbourhood& values, const Offset& at, std::size_t axis) {
  Offset below = at, above = at;
  --below[axis];
  ++above[axis];
  const double here = values.value(at[0], at[1], at[2]);
  const double lower = values.value(below[0], below[1], below[2]), upper = values.value(above[0], above[1], above[2]);
  const bool has_lower = std::isfinite(lower), has_upper = std::isfinite(upper);
  if (has_lower && has_upper) return (upper - lower) / 2;
  if (!std::isfinite(here)) return 0;
  if (has_upper) return upper - here;
  return has_lower ? here - lower : 0;
}

}  // namespace

void hermite_of_field(const Blocks& blocks, const EdgePoints& points, std::span<HermitePoint> data,
                      ProgressMeter& progress) {
  const UniformTiles uniform(blocks.field().thickness());
  const Vec3 spacing = blocks.field().grid().spacing;
  const double unit = blocks.field().grid().max_spacing();
  for_each_block(blocks, uniform, progress,
                 [&](std::size_t, const Block& block, const CornerBits&, const Neighbourhood& values) {
                   HermitePoint* next = data.data() + block.first_vertex;
                   for_each_edge(block, [&](int axis, int x, int y, int z) {
                     const Offset lower{x, y, z};
                     Offset upper = lower;
                     ++upper[static_cast<std::size_t>(axis)];
                     const float a = values.value(x, y, z), b = values.value(upper[0], upper[1], upper[2]);
                     HermitePoint& point = *next++;
                     const double t = points.crossing(a, b);
                     point.t = static_cast<float>(t);
                     Vec3 along;
                     along[axis] = a < b ? 1 : -1;
                     const bool within = values.is_sample(x, y, z) && values.is_sample(upper[0], upper[1], upper[2]);
                     Vec3 normal = along;  // of a cap
                     if (within) {
                       const auto mixed = [&](std::size_t n) {
                         const double s = n == static_cast<std::size_t>(axis)
                                              ? double{b} - a
                                              : slope(values, lower, n) * (1 - t) + slope(values, upper, n) * t;
                         return s;
                       };
                       const Vec3 gradient = Vec3{mixed(0), mixed(1), mixed(2)} / (spacing / Vec3{unit, unit, unit});
                       const double size = max_norm(gradient);
                       if (size > 0 && std::isfinite(size)) {
                         normal = gradient * (1 / size);
                         normal = normal * (1 / length(normal));
                       }
                     }
                     point.set_normal(normal);
                   });
                 });
}

}  // namespace standoff
