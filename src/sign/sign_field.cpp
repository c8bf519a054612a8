// SPDX-License-Identifier: Apache-2.0
#include "sign/sign_field.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>

#include "core/per_thread.h"
#include "core/tile_count.h"
#include "sign/closed.h"
#include "sign/inside_rows.h"
#include "sign/row_crossings.h"
#include "standoff/error.h"
#include "standoff/inspect.h"

namespace standoff {
namespace {

constexpr int kSide = DistanceField::kTileSide, kSamples = DistanceField::kTileSamples;

// Zero stays zero: a sample on the surface has no side.
float negated(float value, bool inside) { return inside && value != 0 ? -value : value; }

// Calls use(rows, ty, tz) for each row of tiles with samples inside.
template <class Use>
void for_each_row_of_tiles(MeshView mesh, const SignOptions& options, const Grid& grid, ProgressMeter& progress,
                           const Use& use) {
  const RowCrossings crossings(mesh, grid, progress);
  PerThread<InsideRows> scratch([&] { return InsideRows(grid, options); });
  const std::int64_t tiles_y = tiles_along(grid.size.y), rows_of_tiles = tiles_y * tiles_along(grid.size.z);
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, rows_of_tiles, 8), [&](const auto& range) {
    progress.check();
    InsideRows& rows = scratch.local();
    for (std::int64_t n = range.begin(); n != range.end(); ++n) {
      const std::int64_t ty = n % tiles_y, tz = n / tiles_y;
      if (rows.fill(crossings.of_tiles(ty, tz), ty, tz)) use(rows, ty, tz);
    }
  });
}

void negate_inside(std::span<const std::uint8_t, 64> inside, std::span<float, kSamples> values) {
  for (std::size_t row = 0; row < inside.size(); ++row) {
    if (inside[row] == 0) continue;
    for (std::size_t x = 0; x < kSide; ++x) {
      float& value = values[kSide * row + x];
      value = negated(value, (inside[row] >> x & 1) != 0);
    }
  }
}

void sign_tile(const InsideRows& rows, std::int64_t tx, std::int64_t ty, std::int64_t tz, DistanceField& field) {
  const std::span<const std::uint8_t, 64> inside = rows.tile(tx);
  if (std::ranges::all_of(inside, [](std::uint8_t byte) { return byte == 0; })) return;
  if (field.tile(tx, ty, tz)) return negate_inside(inside, field.edit_tile(tx, ty, tz));
  if (rows.is_full(tx)) return field.mark_inside(tx, ty, tz);
  const std::span<float, kSamples> values = field.store_tile(tx, ty, tz);
  std::ranges::fill(values, static_cast<float>(field.thickness()));
  if (field.has_nearest()) std::ranges::fill(field.store_nearest(tx, ty, tz), kNoTriangle);
  negate_inside(inside, values);
}

}  // namespace

const char* name_of(SignMethod method) {
  switch (method) {
    case SignMethod::none:
      return "";
    case SignMethod::winding:
      return "winding";
    case SignMethod::parity:
      return "parity";
  }
  return "";
}

void expect_signable(MeshView mesh, const SignOptions& options) {
  if (options.method == SignMethod::none) return;
  const Closed closed = is_closed(mesh);
  if (options.method == SignMethod::parity ? closed.unoriented : closed.oriented) return;
  const std::string open = std::to_string(inspect(mesh).boundary_edges);
  if (!closed.unoriented)
    throw Error(ErrorCode::input, "compute: the mesh is not closed (" + open +
                                      " edges belong to a single triangle), so it has no inside; repair the mesh, or "
                                      "leave out the sign");
  throw Error(ErrorCode::input,
              "compute: neighbouring triangles of the mesh are not oriented alike, so its winding number is no "
              "integer; orient the mesh, or take the sign method parity");
}

void sign_field(MeshView mesh, const SignOptions& options, DistanceField& field, ProgressMeter& progress) {
  const std::int64_t tiles_x = tiles_along(field.grid().size.x);
  for_each_row_of_tiles(mesh, options, field.grid(), progress,
                        [&](const InsideRows& rows, std::int64_t ty, std::int64_t tz) {
                          for (std::int64_t tx = 0; tx < tiles_x; ++tx) sign_tile(rows, tx, ty, tz, field);
                        });
}

void sign_values(MeshView mesh, const SignOptions& options, const Grid& grid, std::span<float> values,
                 ProgressMeter& progress) {
  for_each_row_of_tiles(mesh, options, grid, progress, [&](const InsideRows& rows, std::int64_t ty, std::int64_t tz) {
    for (int row = 0; row < 64; ++row) {
      if (!rows.in_grid(row)) continue;
      const auto first = static_cast<std::size_t>(grid.index(0, kSide * ty + row % kSide, kSide * tz + row / kSide));
      for (std::int64_t i = 0; i < grid.size.x; ++i) {
        float& value = values[first + static_cast<std::size_t>(i)];
        value = negated(value, (rows.byte(row, i / kSide) >> (i % kSide) & 1) != 0);
      }
    }
  });
}

}  // namespace standoff
