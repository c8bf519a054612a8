// SPDX-License-Identifier: Apache-2.0
#include "sign/integer_winding.h"

namespace standoff {

void IntegerWinding::fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const {
  const std::int64_t size = rows.size().x;
  const std::span<const RowCrossing> crossings = crossings_.of_tiles(ty, tz);
  for (auto next = crossings.begin(); next != crossings.end();) {
    const int row = next->row();
    std::int32_t winding = 0;
    std::int64_t from = 0;
    for (; next != crossings.end() && next->row() == row; ++next) {
      if (next->past() != from && is_inside(winding, rule_)) rows.set(row, from, next->past());
      from = next->past();
      winding += next->step();
    }
    if (from < size && is_inside(winding, rule_)) rows.set(row, from, size);
  }
}

}  // namespace standoff
