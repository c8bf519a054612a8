// SPDX-License-Identifier: Apache-2.0
// Points read, answered and written, a block at a time: all three at once, in memory that does not grow.
#pragma once

#include <cstdint>

#include "io/points/answer_writer.h"
#include "io/points/point_reader.h"
#include "standoff/execution.h"
#include "standoff/points.h"
#include "standoff/progress.h"

namespace standoff::cli {

struct PointCounts {
  std::int64_t points = 0;   ///< all
  std::int64_t invalid = 0;  ///< of which were marked as invalid
  std::int64_t inside = 0;   ///< of negative distance
  double least = 0;          ///< distance; the smallest and the largest, with sign
  double largest = 0;
};

/// Answers all points. Errors: those of the reader, the query and the writer, which is not finished then.
PointCounts answer_points(const MeshQuery& query, PointReader& reader, AnswerWriter& writer, const AskedAnswers& asked,
                          const Execution& execution, const ProgressCallback& progress);

}  // namespace standoff::cli
