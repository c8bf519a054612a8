// SPDX-License-Identifier: Apache-2.0
// The integer winding number along the rows of one row of tiles, of two meshes together.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sign/rows/row_crossings.h"

namespace standoff {

/// Samples of a row from `from` on, up to the next run, have this winding number.
struct WindingRun {
  std::int64_t from;
  std::int32_t winding;
};

class RowWindings {
 public:
  /// The crossings of both, each sorted.
  RowWindings(std::span<const RowCrossing> a, std::span<const RowCrossing> b);

  /// The runs of a row; the first one begins at 0.
  std::span<const WindingRun> of_row(int row) const {
    const auto n = static_cast<std::size_t>(row);
    return std::span(runs_).subspan(begin_[n], begin_[n + 1] - begin_[n]);
  }
  /// Calls use(from, to, winding) for the runs among the samples begin to end - 1 of a row.
  template <class Use>
  void for_each(int row, std::int64_t begin, std::int64_t end, const Use& use) const {
    const std::span<const WindingRun> runs = of_row(row);
    for (std::size_t n = 0; n < runs.size() && runs[n].from < end; ++n) {
      const std::int64_t to = n + 1 < runs.size() ? std::min(runs[n + 1].from, end) : end;
      if (to > begin) use(std::max(runs[n].from, begin), to, runs[n].winding);
    }
  }

 private:
  std::array<std::size_t, InsideRows::kRows + 1> begin_;
  std::vector<WindingRun> runs_;
};

}  // namespace standoff
