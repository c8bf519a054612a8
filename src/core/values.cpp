// SPDX-License-Identifier: Apache-2.0
// The values that calls take, and their validation: grids, grids around boxes, poses, and execution; and the version.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/guarded.h"
#include "core/number_text.h"
#include "standoff/error.h"
#include "standoff/grid.h"
#include "standoff/pose.h"
#include "standoff/version.h"

namespace standoff {
namespace {

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::usage, "grid: " + what); }
[[noreturn]] void fail_at_limit(const std::string& what) { throw Error(ErrorCode::limit, "grid: " + what); }

void expect_box(const Box& box) {
  if (box.empty()) fail("the box to cover is empty; give a mesh with triangles");
}

Box grown_by(const Box& box, Vec3 by) {
  expect_box(box);
  const Box grown{box.min - by, box.max + by};
  if (!is_finite(grown.min) || !is_finite(grown.max) || !is_finite(grown.extent()))
    fail("the box to cover is too large; scale the mesh down, or take a smaller padding");
  return grown;
}

// The length of the padding along the axes.
class Reach {
 public:
  Reach(const Box& box, const Padding& padding) : padding_(padding) {
    expect_box(box);
    for (const double number : {padding.length, padding.samples, padding.least_samples})
      if (!(number >= 0) || !std::isfinite(number))
        fail("the padding must be zero or more, and finite; give world units or samples");
    if (!(padding.most_share >= 0))
      fail("the padding's share of the longest side must be zero or more; infinity sets no bound");
    side_ = box.longest_side();
  }

  /// The padding along an axis with this spacing.
  double by_spacing(double spacing) const {
    return combined(padding_.least_samples * spacing, padding_.samples * spacing);
  }
  /// The padding along an axis with this number of cells, of which the cells without the padding cover the extent.
  double by_cells(double extent, double cells) const {
    const auto grown = [&](double samples) {
      if (samples == 0 || extent == 0 || cells == 0) return 0.0;
      return samples * extent / std::max(cells - 2 * samples, 0.0);
    };
    const double by =
        combined(grown(std::clamp((cells - 1) / 2, 0.0, padding_.least_samples)), grown(padding_.samples));
    if (std::isinf(by) && std::isfinite(extent))
      fail("the padding leaves no samples for the box; take less of it, or more samples");
    return by;
  }

 private:
  double combined(double least, double samples) const {
    const double wanted = std::max(padding_.length, samples);
    return std::max(least, side_ > 0 ? std::min(wanted, padding_.most_share * side_) : wanted);
  }

  Padding padding_;
  double side_;
};

// The number of samples for which (samples - 1) * spacing covers the extent. A quotient within rounding of a whole
// number counts as that number.
std::int64_t covering(double extent, double spacing) {
  const double cells = extent / spacing;
  if (!(cells < 0x1p40)) fail_at_limit("more than 2^40 samples on a side; take a larger spacing");
  return static_cast<std::int64_t>(std::ceil(cells * (1 - 1e-12))) + 1;
}

Grid centred(const Box& box, Vec3 spacing) {
  const Vec3 extent = box.extent();
  Grid grid;
  grid.size = {covering(extent.x, spacing.x), covering(extent.y, spacing.y), covering(extent.z, spacing.z)};
  grid.spacing = spacing;
  const Vec3 cells{double(grid.size.x - 1), double(grid.size.y - 1), double(grid.size.z - 1)};
  grid.origin = box.center() - spacing * cells * 0.5;
  validate(grid);
  return grid;
}

}  // namespace

void validate(const Grid& grid) try {
  const auto& s = grid.size;
  if (s.x < 1 || s.y < 1 || s.z < 1) fail("every axis needs at least one sample; give sizes of 1 or more");
  constexpr std::int64_t kMaxSide = std::int64_t{1} << 40;
  if (s.x > kMaxSide || s.y > kMaxSide || s.z > kMaxSide ||
      static_cast<double>(s.x) * static_cast<double>(s.y) * static_cast<double>(s.z) > 0x1p62)
    fail_at_limit("too many samples to count; take fewer");
  for (const std::int64_t first : {grid.first.x, grid.first.y, grid.first.z})
    if (first < 0 || first > kMaxSide)
      fail("a window begins at no sample of its grid; give a first sample from 0 to 2^40 along each axis");
  for (const double h : {grid.spacing.x, grid.spacing.y, grid.spacing.z})
    if (!(h > 0) || !std::isfinite(h)) fail("the spacing must be positive and finite; give it in world units");
  if (!is_finite(grid.origin) || !is_finite(grid.bounds().max))
    fail("the origin and extent must be finite; bring mesh and grid nearer to the origin");
} catch (...) {
  throw_as_error("grid");
}

Padding padding_for(double thickness) try {
  if (!(thickness > 0)) fail("the thickness must be positive; infinity gives a full field");
  if (std::isinf(thickness)) return {};
  return {.length = thickness, .most_share = kMostPadding};
} catch (...) {
  throw_as_error("grid");
}

Padding padding_for_samples(double samples) try {
  if (!(samples > 0)) fail("the band must be positive; infinity gives a full field");
  if (std::isinf(samples)) return {};
  return {.samples = samples, .most_share = kMostPadding};
} catch (...) {
  throw_as_error("grid");
}

Grid fit_resolution(const Box& box, std::int64_t resolution, const Padding& padding) try {
  if (resolution < 2) fail("at least 2 samples are needed on the longest side; give 2 or more");
  const Reach reach(box, padding);
  const double extent = box.longest_side(), cells = static_cast<double>(resolution - 1);
  const bool no_scale = extent == 0 && padding.length == 0 && (padding.samples > 0 || padding.least_samples > 0);
  const double by = no_scale ? cells / 2 : reach.by_cells(extent, cells);
  const Box grown = grown_by(box, {by, by, by});
  const double side = grown.longest_side(), spacing = side > 0 ? side / cells : 1.0;
  if (!(spacing > 0)) fail("the box is too small to divide into that many samples; scale the mesh up");
  return centred(grown, {spacing, spacing, spacing});
} catch (...) {
  throw_as_error("grid");
}

Grid fit_spacing(const Box& box, Vec3 spacing, const Padding& padding) try {
  for (const double h : {spacing.x, spacing.y, spacing.z})
    if (!(h > 0) || !std::isfinite(h)) fail("the spacing must be positive and finite; give it in world units");
  const Reach reach(box, padding);
  const Vec3 by{reach.by_spacing(spacing.x), reach.by_spacing(spacing.y), reach.by_spacing(spacing.z)};
  return centred(grown_by(box, by), spacing);
} catch (...) {
  throw_as_error("grid");
}

Grid fit_size(const Box& box, Size3 size, const Padding& padding) try {
  if (size.x < 1 || size.y < 1 || size.z < 1) fail("every axis needs at least one sample; give sizes of 1 or more");
  const Reach reach(box, padding);
  const auto along = [&](double extent, std::int64_t samples) {
    return reach.by_cells(extent, static_cast<double>(samples - 1));
  };
  const Vec3 whole = box.extent();
  const Box grown = grown_by(box, {along(whole.x, size.x), along(whole.y, size.y), along(whole.z, size.z)});
  const Vec3 extent = grown.extent();
  const std::array<double, 3> extents{extent.x, extent.y, extent.z};
  const std::array<std::int64_t, 3> sizes{size.x, size.y, size.z};
  std::array<double, 3> spacing{};
  for (int axis = 0; axis < 3; ++axis)
    if (sizes[axis] > 1) spacing[axis] = extents[axis] / static_cast<double>(sizes[axis] - 1);
  const double widest = std::max({spacing[0], spacing[1], spacing[2]});
  for (double& h : spacing)
    if (!(h > 0)) h = widest > 0 ? widest : 1.0;
  Grid grid{size, {}, {spacing[0], spacing[1], spacing[2]}};
  const Vec3 cells{double(size.x - 1), double(size.y - 1), double(size.z - 1)};
  grid.origin = grown.center() - grid.spacing * cells * 0.5;
  validate(grid);
  return grid;
} catch (...) {
  throw_as_error("grid");
}

Pose compose(const Pose& outer, const Pose& inner) {
  Pose result;
  for (int column = 0; column < 3; ++column) {
    const auto& r = inner.rotation;
    const Vec3 turned = rotate(outer, {r[column], r[3 + column], r[6 + column]});
    result.rotation[column] = turned.x, result.rotation[3 + column] = turned.y, result.rotation[6 + column] = turned.z;
  }
  result.translation = apply(outer, inner.translation);
  return result;
}

Pose make_pose(Vec3 axis, double angle_rad, Vec3 translation) try {
  const double largest = max_norm(axis);
  if (!(largest > 0) || !is_finite(axis) || !std::isfinite(angle_rad) || !is_finite(translation))
    throw Error(
        ErrorCode::usage,
        "pose: the axis needs a direction, and all numbers must be finite; give an axis of any length but zero");
  // Scale by a power of two: it changes no digit of the direction, and keeps squares of the smallest and largest
  // numbers within range.
  const int exponent = -std::ilogb(largest);
  const Vec3 scaled{std::scalbn(axis.x, exponent), std::scalbn(axis.y, exponent), std::scalbn(axis.z, exponent)};
  const Vec3 u = scaled * (1 / length(scaled));
  const double c = std::cos(angle_rad), s = std::sin(angle_rad), k = 1 - c;
  Pose pose;
  pose.rotation = {c + u.x * u.x * k,       u.x * u.y * k - u.z * s, u.x * u.z * k + u.y * s,
                   u.y * u.x * k + u.z * s, c + u.y * u.y * k,       u.y * u.z * k - u.x * s,
                   u.z * u.x * k - u.y * s, u.z * u.y * k + u.x * s, c + u.z * u.z * k};
  pose.translation = translation;
  return pose;
} catch (...) {
  throw_as_error("pose");
}

void validate(const Pose& pose) try {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::usage, "pose: " + what); };
  for (const double r : pose.rotation)
    if (!std::isfinite(r)) fail("the rotation holds a number that is not finite; give nine finite numbers");
  const Vec3 t = pose.translation;
  if (!is_finite(t) || max_norm(t) > kMaxPosition)
    fail("the translation is not finite or past " + number_text(kMaxPosition) +
         "; give three finite numbers, or another unit of length");
  const auto& r = pose.rotation;
  const Vec3 rows[3] = {{r[0], r[1], r[2]}, {r[3], r[4], r[5]}, {r[6], r[7], r[8]}};
  double off = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) off = std::max(off, std::abs(dot(rows[i], rows[j]) - (i == j ? 1 : 0)));
  if (!(off <= kRigidTolerance))
    fail("the matrix is no rotation: its rows are off unit length and right angles by " + number_text(off) +
         "; take scaling and shear out of it");
  if (!(dot(cross(rows[0], rows[1]), rows[2]) > 0)) fail("the matrix mirrors; a rigid body cannot, negate one axis");
} catch (...) {
  throw_as_error("pose");
}

void validate(const char* where, const Execution& execution, Runs runs) {
  const auto fail = [where](const std::string& what) {
    throw Error(ErrorCode::usage, std::string(where) + ": " + what);
  };
  if (execution.threads < 0 || execution.threads > kMaxThreads)
    fail(std::to_string(execution.threads) + " threads were asked for; ask for 1 to " + std::to_string(kMaxThreads) +
         ", or 0 for all");
  if (execution.device < 0)
    fail("there is no device " + std::to_string(execution.device) + "; devices are counted from 0");
  // A caller may have cast any number to an enumeration.
  const auto one_of = [](auto value, auto last) { return value >= decltype(value){} && value <= last; };
  if (!find_info(execution.backend)) fail("there is no such backend; take one of enum Backend");
  if (!one_of(execution.simd, Simd::avx512)) fail("there is no such instruction set; take one of enum Simd");
  if (runs == Runs::on_the_cpu && execution.backend != Backend::automatic && execution.backend != Backend::cpu)
    fail("this runs on the CPU only; take Backend::automatic or Backend::cpu");
}

const char* version() { return STANDOFF_VERSION; }

}  // namespace standoff
