// SPDX-License-Identifier: Apache-2.0
#include "field/float_range.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "standoff/error.h"

namespace standoff {
namespace {

constexpr double kLeastSpacing = 0x1p-110, kLargestSpacing = 0x1p100;
constexpr double kMostUneven = 0x1p60;  // the largest spacing to the least

bool is_moderate(double spacing) { return spacing >= kLeastSpacing && spacing <= kLargestSpacing; }
bool is_even(Vec3 h) { return std::min({h.x, h.y, h.z}) >= std::max({h.x, h.y, h.z}) / kMostUneven; }

void check_spacing(const Grid& grid) {
  if (!is_moderate(grid.max_spacing()))
    throw Error(ErrorCode::limit, "compute: the spacing is " + std::to_string(std::ilogb(grid.max_spacing())) +
                                      " binary orders from one, too many for values in float; scale mesh and grid");
  if (!is_even(grid.spacing))
    throw Error(ErrorCode::limit,
                "compute: one spacing is less than 2^-60 of another, too little for float; take more even spacings");
}

constexpr const char* kTooFar =
    " is farther than 2^60 spacings, or 2^125 units, from the grid; remove it, scale the mesh or coarsen the grid";

}  // namespace

FloatRange::FloatRange(const Grid& grid)
    : center_(grid.bounds().center()), farthest_(std::min(0x1p60 * grid.max_spacing(), 0x1p125)) {}

bool has_float_spacing(const Grid& grid) { return is_moderate(grid.max_spacing()) && is_even(grid.spacing); }

void check_domain(MeshView mesh, const Grid& grid) {
  check_spacing(grid);
  const FloatRange near(grid);
  const auto is_far = [&](const tbb::blocked_range<std::size_t>& range, std::size_t first) {
    for (std::size_t t = range.begin(); t < range.end() && t < first; ++t)
      for (int k = 0; k < 3; ++k)
        if (!near.holds(mesh.corner(t, k))) return t;
    return first;
  };
  const std::size_t none = mesh.triangles.size();
  const std::size_t found = tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, none, 8192), none, is_far,
                                                 [](std::size_t a, std::size_t b) { return std::min(a, b); });
  if (found != none)
    throw Error(ErrorCode::limit, "mesh: triangle " + std::to_string(found) + kTooFar,
                {.triangle = static_cast<std::int64_t>(found)});
}

void check_domain(const Box& mesh, const Grid& grid) {
  check_spacing(grid);
  const FloatRange near(grid);
  if (!near.holds(mesh.min) || !near.holds(mesh.max))
    throw Error(ErrorCode::limit, std::string("mesh: a corner of its box") + kTooFar);
}

}  // namespace standoff
