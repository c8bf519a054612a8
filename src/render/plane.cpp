// SPDX-License-Identifier: Apache-2.0
#include "render/plane.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/guarded.h"
#include "render/best_plane.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// An axis is taken before another one if that does not show more than this.
constexpr double kWorthAnotherAxis = 1 / 0.98;

std::int64_t samples_along(const DistanceField& field, Axis axis) {
  const Size3& size = field.grid().size;
  return axis == Axis::x ? size.x : axis == Axis::y ? size.y : size.z;
}

// The sample that the options name, if they name one. Errors: usage.
std::optional<std::int64_t> named_index(const SliceOptions& options, std::int64_t count) {
  if (options.index) {
    if (*options.index < 0 || *options.index >= count)
      throw Error(ErrorCode::usage, "slice: sample " + std::to_string(*options.index) +
                                        " is outside the field, which has " + std::to_string(count) +
                                        " along that axis; count from 0");
    return options.index;
  }
  if (!options.at) return std::nullopt;
  if (!(*options.at >= 0 && *options.at <= 1))
    throw Error(ErrorCode::usage, "slice: the place must be 0 (the first sample) to 1 (the last); 0.5 is the middle");
  return std::llround(*options.at * static_cast<double>(count - 1));
}

SlicePlane placed(const DistanceField& field, Axis axis, std::int64_t index) {
  const auto& [size, origin, h] = field.grid();
  const auto at = static_cast<double>(index);
  return {axis, index,
          axis == Axis::x   ? origin.x + h.x * at
          : axis == Axis::y ? origin.y + h.y * at
                            : origin.z + h.z * at};
}

// The most that a plane of this axis shows, and which one.
SlicePlane best_along(const DistanceField& field, const SliceOptions& options, const PlaneScores& scores, Axis axis,
                      double& shown) {
  const std::vector<std::int64_t>& along = scores.along[static_cast<std::size_t>(axis)];
  std::int64_t index = named_index(options, std::ssize(along)).value_or(best_plane(along));
  if (index < 0) index = std::ssize(along) / 2;
  shown = static_cast<double>(along[static_cast<std::size_t>(index)]) * scores.area[static_cast<std::size_t>(axis)];
  return placed(field, axis, index);
}

SlicePlane chosen(const DistanceField& field, const SliceOptions& options) {
  if (options.axis) {
    if (*options.axis != Axis::x && *options.axis != Axis::y && *options.axis != Axis::z)
      throw Error(ErrorCode::usage, "slice: there is no such axis; take x, y or z");
    // Where all is said, no pass over the field is needed.
    if (const auto index = named_index(options, samples_along(field, *options.axis)))
      return placed(field, *options.axis, *index);
  }
  const PlaneScores scores = plane_scores(field);
  double most = -1, shown = 0;
  if (options.axis) return best_along(field, options, scores, *options.axis, shown);
  const Size3& size = field.grid().size;
  const std::int64_t longest = std::max({size.x, size.y, size.z});
  SlicePlane best;
  for (const Axis axis : {Axis::z, Axis::y, Axis::x}) {
    // A sample that only the longest axes have is one of theirs.
    if (options.index && *options.index >= samples_along(field, axis) && samples_along(field, axis) < longest) continue;
    const SlicePlane other = best_along(field, options, scores, axis, shown);
    if (shown <= most * kWorthAnotherAxis) continue;
    best = other;
    most = shown;
  }
  return best;
}

}  // namespace

Plane plane_of(const DistanceField& field, const SliceOptions& options) {
  const SlicePlane where = chosen(field, options);
  const auto& [size, origin, h] = field.grid();
  Plane plane;
  plane.index = where.index;
  plane.count = samples_along(field, where.axis);
  plane.position = where.position;
  struct Side {
    char name;
    std::int64_t count;
    double first, step;
  };
  const auto across = [&](char normal, Side right, Side up) {
    plane.normal = normal;
    plane.right = right.name;
    plane.width = right.count;
    plane.first_right = right.first;
    plane.step_right = right.step;
    plane.up = up.name;
    plane.height = up.count;
    plane.first_up = up.first;
    plane.step_up = up.step;
    plane.values.resize(static_cast<std::size_t>(right.count * up.count));
  };
  const auto fill = [&](auto value_at) {
    auto out = plane.values.begin();
    for (std::int64_t u = 0; u < plane.height; ++u)
      for (std::int64_t r = 0; r < plane.width; ++r) *out++ = value_at(r, u);
  };
  const Side x{'x', size.x, origin.x, h.x}, y{'y', size.y, origin.y, h.y}, z{'z', size.z, origin.z, h.z};
  switch (where.axis) {
    case Axis::x:
      across('x', y, z);
      fill([&](auto r, auto u) { return field.value(plane.index, r, u); });
      break;
    case Axis::y:
      across('y', x, z);
      fill([&](auto r, auto u) { return field.value(r, plane.index, u); });
      break;
    case Axis::z:
      across('z', x, y);
      field.copy_slices(plane.index, 1, plane.values);
      break;
  }
  return plane;
}

SlicePlane slice_plane(const DistanceField& field, const SliceOptions& options) try {
  return chosen(field, options);
} catch (...) {
  throw_as_error("slice");
}

}  // namespace standoff
