// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/row_windings.h"

namespace standoff {

RowWindings::RowWindings(std::span<const RowCrossing> a, std::span<const RowCrossing> b) {
  runs_.reserve(InsideRows::kRows + a.size() + b.size());
  const auto in_row = [](std::span<const RowCrossing> rest, int row) { return !rest.empty() && rest[0].row() == row; };
  for (int row = 0; row < InsideRows::kRows; ++row) {
    begin_[static_cast<std::size_t>(row)] = runs_.size();
    runs_.push_back({0, 0});
    while (in_row(a, row) || in_row(b, row)) {
      auto& next = !in_row(b, row) || (in_row(a, row) && a[0] < b[0]) ? a : b;
      if (next[0].past() != runs_.back().from) runs_.push_back({next[0].past(), runs_.back().winding});
      runs_.back().winding += next[0].step();
      next = next.subspan(1);
    }
  }
  begin_.back() = runs_.size();
}

}  // namespace standoff
