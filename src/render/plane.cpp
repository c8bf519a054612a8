// SPDX-License-Identifier: Apache-2.0
#include "render/plane.h"

#include <cmath>
#include <string>

#include "standoff/error.h"

namespace standoff {
namespace {

std::int64_t index_along(const SliceOptions& options, std::int64_t count) {
  if (options.index) {
    if (*options.index < 0 || *options.index >= count)
      throw Error(ErrorCode::usage, "slice: sample " + std::to_string(*options.index) +
                                        " is outside the field, which has " + std::to_string(count) +
                                        " along that axis; count from 0");
    return *options.index;
  }
  if (!(options.at >= 0 && options.at <= 1))
    throw Error(ErrorCode::usage, "slice: the place must be 0 (the first sample) to 1 (the last); 0.5 is the middle");
  return std::llround(options.at * static_cast<double>(count - 1));
}

}  // namespace

Plane plane_of(const DistanceField& field, const SliceOptions& options) {
  const auto& [size, origin, h] = field.grid();
  Plane plane;
  const auto along = [&](std::int64_t count, double first, double step) {
    plane.count = count;
    plane.index = index_along(options, count);
    plane.position = first + step * static_cast<double>(plane.index);
  };
  const auto across = [&](char normal, char right, std::int64_t width, double step_right, char up, std::int64_t height,
                          double step_up) {
    plane.normal = normal;
    plane.right = right;
    plane.up = up;
    plane.width = width;
    plane.height = height;
    plane.step_right = step_right;
    plane.step_up = step_up;
    plane.values.resize(static_cast<std::size_t>(width * height));
  };
  const auto fill = [&](auto value_at) {
    auto out = plane.values.begin();
    for (std::int64_t u = 0; u < plane.height; ++u)
      for (std::int64_t r = 0; r < plane.width; ++r) *out++ = value_at(r, u);
  };
  switch (options.axis) {
    case Axis::x:
      along(size.x, origin.x, h.x);
      across('x', 'y', size.y, h.y, 'z', size.z, h.z);
      fill([&](auto r, auto u) { return field.value(plane.index, r, u); });
      break;
    case Axis::y:
      along(size.y, origin.y, h.y);
      across('y', 'x', size.x, h.x, 'z', size.z, h.z);
      fill([&](auto r, auto u) { return field.value(r, plane.index, u); });
      break;
    case Axis::z:
      along(size.z, origin.z, h.z);
      across('z', 'x', size.x, h.x, 'y', size.y, h.y);
      field.copy_slices(plane.index, 1, plane.values);
      break;
    default:
      throw Error(ErrorCode::usage, "slice: there is no such axis; take x, y or z");
  }
  return plane;
}

}  // namespace standoff
