// SPDX-License-Identifier: Apache-2.0
#include "sign/rows/integer_winding.h"

namespace standoff {

void IntegerWinding::fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const {
  std::int32_t winding = 0;
  int row = -1;
  for (const RowCrossing& crossing : crossings_.of_tiles(ty, tz)) {
    winding = crossing.row() == row ? winding : 0;
    row = crossing.row();
    const bool before = is_inside(winding, rule_);
    winding += crossing.step();
    rows.toggle(row, crossing.past(), is_inside(winding, rule_) != before);
  }
  rows.finish_toggles();
}

}  // namespace standoff
