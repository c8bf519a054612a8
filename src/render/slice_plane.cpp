// SPDX-License-Identifier: Apache-2.0
// Which plane of a field is shown, and what lies between its samples: values, the end of the band, lines of one value.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "core/guarded.h"
#include "core/tile_count.h"
#include "render/slice.h"
#include "standoff/error.h"

namespace standoff {
namespace {

constexpr double kUnit = 256;          // a whole number for each share: sums do not depend on their order
constexpr double kNearlyAsMuch = 0.9;  // such planes compete for the middle
constexpr double kFarthest = 3;        // samples count up to so many spacings from the surface,
constexpr double kNearestShare =
    1.0 / 3.0;  // and from this share of that on: nearer ones see the kink of unsigned fields

std::array<std::int64_t, 3> coordinates(const Size3& s) { return {s.x, s.y, s.z}; }

// A tile's samples that count, each added to its three planes.
class ShownCounter {
 public:
  ShownCounter(const DistanceField& field, PlaneScores& scores)
      : size_(coordinates(field.grid().size)),
        spacing_{field.grid().spacing.x, field.grid().spacing.y, field.grid().spacing.z},
        scores_(scores) {
    far_ = std::min(field.thickness(), kFarthest * std::max({spacing_[0], spacing_[1], spacing_[2]}));
  }

  void add(const DistanceField::Tile& tile) {
    first_ = coordinates(tile.at);
    for (std::size_t c = 0; c < 3; ++c) {
      first_[c] *= kTileSide;
      last_[c] = static_cast<int>(std::min<std::int64_t>(kTileSide, size_[c] - first_[c])) - 1;
    }
    for (int n = 0; n < DistanceField::kTileSamples; ++n) {
      const double distance = std::abs(static_cast<double>(tile.values[static_cast<std::size_t>(n)]));
      if (distance >= kNearestShare * far_ && distance < far_)
        add(tile.values, {n % kTileSide, n / kTileSide % kTileSide, n / (kTileSide * kTileSide)});
    }
  }

 private:
  void add(DistanceField::TileValues values, const std::array<int, 3>& at) {
    constexpr std::array<int, 3> kStride{1, kTileSide, kTileSide * kTileSide};
    const int index = at[0] + kTileSide * at[1] + kTileSide * kTileSide * at[2];
    std::array<double, 3> squared{};
    for (std::size_t c = 0; c < 3; ++c) {
      if (at[c] > last_[c]) return;  // beyond the grid
      const int before = std::max(at[c] - 1, 0) - at[c], after = std::min(at[c] + 1, last_[c]) - at[c];
      if (before == after) continue;
      const auto value = [&](int steps) {
        return static_cast<double>(values[static_cast<std::size_t>(index + steps * kStride[c])]);
      };
      const double slope = (value(after) - value(before)) / ((after - before) * spacing_[c]);
      squared[c] = slope * slope;
    }
    const double sum = squared[0] + squared[1] + squared[2];
    if (!(sum > 0) || !std::isfinite(sum)) return;
    for (std::size_t c = 0; c < 3; ++c)
      scores_.along[c][static_cast<std::size_t>(first_[c] + at[c])] += std::llround(kUnit * (1 - squared[c] / sum));
  }

  std::array<std::int64_t, 3> size_, first_{};
  std::array<double, 3> spacing_;
  std::array<int, 3> last_{};
  double far_ = 0;
  PlaneScores& scores_;
};

}  // namespace

PlaneScores plane_scores(const DistanceField& field) {
  const Size3& size = field.grid().size;
  const Vec3& h = field.grid().spacing;
  PlaneScores scores{.area = {h.y * h.z, h.x * h.z, h.x * h.y}};
  for (std::size_t c = 0; c < 3; ++c) scores.along[c].resize(static_cast<std::size_t>(coordinates(size)[c]));
  ShownCounter counter(field, scores);
  for (const DistanceField::Tile& tile : field.tiles()) counter.add(tile);
  return scores;
}

std::int64_t best_plane(const std::vector<std::int64_t>& scores) {
  const std::int64_t most = *std::ranges::max_element(scores);
  if (most == 0) return -1;
  const auto shows = [](std::int64_t score) { return score > 0; };
  const auto first = std::ranges::find_if(scores, shows) - scores.begin();
  const auto end = std::find_if(scores.rbegin(), scores.rend(), shows).base() - scores.begin();
  const std::int64_t twice_middle = first + end - 1;
  std::int64_t best = -1;
  for (std::int64_t n = 0; n < std::ssize(scores); ++n) {
    if (static_cast<double>(scores[static_cast<std::size_t>(n)]) < kNearlyAsMuch * static_cast<double>(most)) continue;
    if (best < 0 || std::abs(2 * n - twice_middle) < std::abs(2 * best - twice_middle)) best = n;
  }
  return best;
}

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
  const Vec3 at = field.grid().position(index, index, index);
  return {axis, index, axis == Axis::x ? at.x : axis == Axis::y ? at.y : at.z};
}

// The plane of this axis that shows the most, and how much it shows.
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
    // Where the options name axis and sample, no pass over the field is needed.
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
    // A sample that only the longest axes have must be one of theirs.
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
  const Size3& size = field.grid().size;
  const Vec3 &h = field.grid().spacing, origin = field.grid().corner();
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
  if (options.part) {
    plane.index += options.part->first;
    plane.count = options.part->count;
  }
  return plane;
}

Plane upright(const Plane& plane, std::optional<Axis> up) {
  if (!up || plane.right != name_of(*up)) return plane;
  Plane turned = plane;
  std::swap(turned.right, turned.up);
  std::swap(turned.width, turned.height);
  std::swap(turned.first_right, turned.first_up);
  std::swap(turned.step_right, turned.step_up);
  auto out = turned.values.begin();
  for (std::int64_t u = 0; u < turned.height; ++u)
    for (std::int64_t r = 0; r < turned.width; ++r) *out++ = plane.value(u, r);
  return turned;
}

SlicePlane slice_plane(const DistanceField& field, const SliceOptions& options) try {
  return chosen(field, options);
} catch (...) {
  throw_as_error("slice");
}

namespace {

// Where only a diagonal neighbour is in the band, the value exceeds the thickness by this share of a spacing.
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
  // Extrapolates from a neighbour and, if it is in the band too, the sample behind it; at most `way` is added.
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

namespace {

// Between which samples the centre of a pixel lies.
struct Between {
  std::int64_t first, second;
  float share;  // of the second
};
Between between(double place, std::int64_t count) {
  const double at = std::clamp(place * static_cast<double>(count) - 0.5, 0.0, static_cast<double>(count - 1));
  const auto first = static_cast<std::int64_t>(at);
  return {first, std::min(first + 1, count - 1), static_cast<float>(at - static_cast<double>(first))};
}

// Exact where both are equal, as clamped values are, and never beyond them.
float mix(float a, float b, float share) { return share == 0 || a == b ? a : a * (1 - share) + b * share; }

// The slope through a pixel from its neighbours along one axis, as far as these are finite.
double slope(float before, float value, float after) {
  const double first = std::isfinite(before) ? static_cast<double>(value) - before : 0;
  const double second = std::isfinite(after) ? static_cast<double>(after) - value : 0;
  return std::isfinite(before) && std::isfinite(after) ? (first + second) / 2 : first + second;
}

}  // namespace

std::vector<float> interpolated(const Plane& plane, int width, int height) {
  std::vector<Between> columns;
  for (int x = 0; x < width; ++x) columns.push_back(between((x + 0.5) / width, plane.width));
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    const Between up = between((height - y - 0.5) / height, plane.height);
    for (const Between& right : columns) {
      const auto row = [&](std::int64_t u) {
        return mix(plane.value(right.first, u), plane.value(right.second, u), right.share);
      };
      values.push_back(mix(row(up.first), row(up.second), up.share));
    }
  }
  return values;
}

namespace {

// A grid of values with its neighbours.
struct Values {
  const std::vector<float>& all;
  int width, height;

  float at(int x, int y) const {
    const bool outside = x < 0 || y < 0 || x >= width || y >= height;
    return outside ? std::numeric_limits<float>::quiet_NaN() : all[static_cast<std::size_t>(y) * width + x];
  }
  // Pixels from a pixel's centre to the level, positive above it, as if values were linear with the slope there.
  double distance(int x, int y, double level) const {
    const float value = at(x, y);
    const double slope_x = slope(at(x - 1, y), value, at(x + 1, y)), slope_y = slope(at(x, y - 1), value, at(x, y + 1));
    const double steepness = std::sqrt(slope_x * slope_x + slope_y * slope_y);
    const double above = value - level;
    return steepness > 0 ? above / steepness : above < 0 ? -kFar : kFar;
  }
  // Whether one of the eight pixels around this one is on the other side.
  bool passes(int x, int y, double level) const {
    const bool below = at(x, y) < level;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const float near = at(x + dx, y + dy);
        if (std::isfinite(near) && (near < level) != below) return true;
      }
    return false;
  }
  static constexpr double kFar = 1e9;
};

}  // namespace

std::vector<float> level_line(const std::vector<float>& values, int width, int height, double level,
                              double line_width) {
  const Values grid{values, width, height};
  std::vector<float> covered(values.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      // A line at most 2 pixels wide reaches no farther than the neighbours of the pixels that it passes between.
      if (!std::isfinite(grid.at(x, y)) || !grid.passes(x, y, level)) continue;
      const double distance = std::abs(grid.distance(x, y, level));
      covered[static_cast<std::size_t>(y) * width + x] =
          static_cast<float>(std::clamp(line_width / 2 + 0.5 - distance, 0.0, 1.0));
    }
  return covered;
}

std::vector<float> share_above(const std::vector<float>& values, int width, int height, double level) {
  const Values grid{values, width, height};
  std::vector<float> shares(values.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float value = grid.at(x, y);
      const bool edge = std::isfinite(value) && grid.passes(x, y, level);
      const double share = edge ? std::clamp(0.5 + grid.distance(x, y, level), 0.0, 1.0) : value >= level ? 1.0 : 0.0;
      shares[static_cast<std::size_t>(y) * width + x] = static_cast<float>(share);
    }
  return shares;
}

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

std::optional<float> early_end(const std::vector<float>& values) {
  constexpr double kShare = 0.95;
  std::vector<float> finite;
  std::ranges::copy_if(values, std::back_inserter(finite), [](float value) { return std::isfinite(value); });
  if (finite.empty()) return std::nullopt;
  const auto end = finite.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(finite.size() - 1));
  std::ranges::nth_element(finite, end);
  const float greatest = *std::max_element(end, finite.end());
  return *end > 0 && *end < 0.9F * greatest ? std::optional(*end) : std::nullopt;
}

float surface_level(const DistanceField& field) {
  return field.has_sign() ? 0 : static_cast<float>(0.6 * field.grid().max_spacing());
}

SliceTexture::SliceTexture(const DistanceField& field, const SliceOptions& where)
    : plane_(plane_of(field, where)),
      extended_(beyond_band(plane_, static_cast<float>(field.thickness()))),
      thickness_(static_cast<float>(field.thickness())),
      surface_level_(standoff::surface_level(field)) {}

SliceTexture::Values SliceTexture::at(float right, float up) const {
  const Neighbours r(right, plane_.width), u(up, plane_.height);
  const auto between = [&](const Plane& plane) {
    return u.mix(r.mix(plane.value(r.first, u.first), plane.value(r.second, u.first)),
                 r.mix(plane.value(r.first, u.second), plane.value(r.second, u.second)));
  };
  return {between(plane_), between(extended_)};
}

}  // namespace standoff
