#include "standoff/grid.h"

#include <array>
#include <cmath>
#include <string>

#include "core/guarded.h"
#include "standoff/error.h"

namespace standoff {
namespace {

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::usage, "grid: " + what); }
[[noreturn]] void fail_at_limit(const std::string& what) { throw Error(ErrorCode::limit, "grid: " + what); }

Box padded(const Box& box, double padding) {
  if (box.empty()) fail("the box to cover is empty; give a mesh with triangles");
  if (!(padding >= 0) || !std::isfinite(padding))
    fail("the padding must be zero or more, and finite; give it in world units");
  const Box grown = box.grown(padding);
  if (!is_finite(grown.min) || !is_finite(grown.max) || !is_finite(grown.extent()))
    fail("the box to cover is too large; scale the mesh down, or take a smaller padding");
  return grown;
}

// Samples so that (samples - 1) * spacing covers the extent. Quotients within rounding of a whole number count as it.
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

double longest(Vec3 extent) { return std::max({extent.x, extent.y, extent.z}); }

}  // namespace

void validate(const Grid& grid) try {
  const auto& s = grid.size;
  if (s.x < 1 || s.y < 1 || s.z < 1) fail("every axis needs at least one sample; give sizes of 1 or more");
  constexpr std::int64_t kMaxSide = std::int64_t{1} << 40;
  if (s.x > kMaxSide || s.y > kMaxSide || s.z > kMaxSide ||
      static_cast<double>(s.x) * static_cast<double>(s.y) * static_cast<double>(s.z) > 0x1p62)
    fail_at_limit("too many samples to count; take fewer");
  for (const double h : {grid.spacing.x, grid.spacing.y, grid.spacing.z})
    if (!(h > 0) || !std::isfinite(h)) fail("the spacing must be positive and finite; give it in world units");
  if (!is_finite(grid.origin) || !is_finite(grid.bounds().max))
    fail("the origin and extent must be finite; bring mesh and grid nearer to the origin");
} catch (...) {
  throw_as_error("grid");
}

Grid fit_samples(const Box& box, std::int64_t samples, double padding) try {
  if (samples < 2) fail("at least 2 samples are needed on the longest side; give 2 or more");
  const Box grown = padded(box, padding);
  const double side = longest(grown.extent());
  const double spacing = side > 0 ? side / static_cast<double>(samples - 1) : 1.0;
  if (!(spacing > 0)) fail("the box is too small to divide into that many samples; scale the mesh up");
  return centred(grown, {spacing, spacing, spacing});
} catch (...) {
  throw_as_error("grid");
}

Grid fit_spacing(const Box& box, Vec3 spacing, double padding) try {
  for (const double h : {spacing.x, spacing.y, spacing.z})
    if (!(h > 0) || !std::isfinite(h)) fail("the spacing must be positive and finite; give it in world units");
  return centred(padded(box, padding), spacing);
} catch (...) {
  throw_as_error("grid");
}

Grid fit_size(const Box& box, Size3 size, double padding) try {
  if (size.x < 1 || size.y < 1 || size.z < 1) fail("every axis needs at least one sample; give sizes of 1 or more");
  const Box grown = padded(box, padding);
  const Vec3 extent = grown.extent();
  const std::array<double, 3> extents{extent.x, extent.y, extent.z};
  const std::array<std::int64_t, 3> sizes{size.x, size.y, size.z};
  std::array<double, 3> spacing{};
  for (int axis = 0; axis < 3; ++axis)
    if (sizes[axis] > 1) spacing[axis] = extents[axis] / static_cast<double>(sizes[axis] - 1);
  const double widest = longest({spacing[0], spacing[1], spacing[2]});
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

}  // namespace standoff
