// SPDX-License-Identifier: Apache-2.0
#include "standoff/occupancy.h"

#include <bit>
#include <numeric>

#include "core/execution.h"
#include "core/guarded.h"
#include "core/threads.h"
#include "sign/each_row_of_tiles.h"
#include "sign/make_sides.h"
#include "sign/options.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// The bytes of tiles are the bytes of rows.
void copy_rows(const InsideRows& rows, std::int64_t ty, std::int64_t tz, Occupancy& to) {
  constexpr std::int64_t kSide = InsideRows::kSide;
  for (int row = 0; row < InsideRows::kRows; ++row) {
    if (!rows.in_grid(row)) continue;
    const std::int64_t j = kSide * ty + row % kSide, k = kSide * tz + row / kSide;
    std::uint8_t* const bytes = to.bits.data() + (k * to.grid.size.y + j) * to.row_bytes();
    for (std::int64_t tx = 0; tx < to.row_bytes(); ++tx) bytes[tx] = rows.tile(tx)[static_cast<std::size_t>(row)];
  }
}

}  // namespace

std::int64_t Occupancy::count() const {
  return std::accumulate(bits.begin(), bits.end(), std::int64_t{0},
                         [](std::int64_t sum, std::uint8_t byte) { return sum + std::popcount(byte); });
}

Occupancy occupancy(MeshView mesh, const Grid& grid, const SignOptions& sign, const Execution& execution,
                    const ProgressCallback& progress) try {
  validate("occupancy", execution, Runs::on_the_cpu);
  validate(grid);
  validate(sign);
  for (const SignMethod method : {SignMethod::none, SignMethod::normal, SignMethod::shell})
    if (sign.method == method)
      throw Error(ErrorCode::usage,
                  "occupancy: this sign method decides nothing without distances; take winding, parity or flood, or "
                  "compute a field");
  validate(mesh);
  Occupancy found{grid, {}, {}};
  ProgressMeter meter(progress);
  Threads(execution.threads).run([&] {
    meter.stage("sign", 1, 0, 1);
    SignPlan plan = plan_sign(mesh, sign);
    found.bits.resize(static_cast<std::size_t>(found.row_bytes() * grid.size.y * grid.size.z));
    const auto sides = plan.has_sign() ? make_sides(mesh, plan, sign, {grid}, meter) : nullptr;
    if (sides) {
      for_each_row_of_tiles(
          *sides, sign.invert, grid, meter,
          [&](const InsideRows& rows, std::int64_t ty, std::int64_t tz) { copy_rows(rows, ty, tz, found); });
    }
    found.sign = plan.report;
  });
  meter.stage("done", 1, 1, 1);
  return found;
} catch (...) {
  throw_as_error("occupancy", "take fewer samples, or provide more memory");
}

}  // namespace standoff
