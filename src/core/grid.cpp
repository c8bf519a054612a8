// SPDX-License-Identifier: Apache-2.0
#include "standoff/grid.h"

#include <cmath>
#include <string>

#include "core/guarded.h"
#include "standoff/error.h"

namespace standoff {
namespace {

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::usage, "grid: " + what); }
[[noreturn]] void fail_at_limit(const std::string& what) { throw Error(ErrorCode::limit, "grid: " + what); }

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

}  // namespace standoff
