// SPDX-License-Identifier: Apache-2.0
// The parts of standoff/cuda.h and standoff/cuda_batch.h that need no GPU.
#include "standoff/cuda.h"

#include <string>

#include "core/guarded.h"
#include "field/backend.h"
#include "field/cuda/capacity.h"
#include "standoff/error.h"

namespace standoff::cuda {

std::int64_t likely_entries(std::int64_t triangles, const Grid& grid, double thickness, Method method) try {
  validate(grid);
  check_counts(triangles, thickness, 0);
  return method == Method::tiles ? estimate_list_entries(triangles, grid, thickness) : 0;
} catch (...) {
  throw_as_error("cuda");
}

void check(const Outcome& outcome, const Task& task) try {
  if (outcome.stopped == 0 && outcome.doubts == 0) return;
  if (outcome.stopped == 0)
    throw Error(
        ErrorCode::input,
        std::string("cuda: the device found no sign: the mesh ") +
            ((outcome.doubts & Outcome::kOpen) != 0          ? "is not closed"
             : (outcome.doubts & Outcome::kNotOutwards) != 0 ? "has parts that do not face outwards, or too many parts"
                                                             : "has more than 127 layers between two samples") +
            "; the magnitudes of the values are right, their signs are undefined; let compute_each() or compute() "
            "decide the sign");
  if (outcome.bad_triangle != Outcome::kNone)
    throw Error(ErrorCode::input,
                "cuda: triangle " + std::to_string(outcome.bad_triangle) +
                    " has an index out of range or a corner that is not finite; repair the mesh",
                {.triangle = static_cast<std::int64_t>(outcome.bad_triangle)});
  if (outcome.needed_entries == Outcome::kNoSeeds) throw_no_seeds();
  if (outcome.needed_entries == Outcome::kNoPlace)
    throw Error(
        ErrorCode::usage,
        "cuda: the mesh's place among many is not valid; give it a finite origin, positive spacings of moderate "
        "size, and a positive thickness of at most four times the largest spacing");
  if (outcome.needed_entries == Outcome::kNoOrder)
    throw Error(ErrorCode::usage,
                "cuda: first_vertex or first_triangle do not ascend from 0 to the number of all; nothing was written, "
                "give them a number per mesh and one behind the last");
  if (outcome.needed_entries == Outcome::kNone)
    throw Error(ErrorCode::input,
                "cuda: the mesh changed while its field was computed; nothing was written, let the work end before the "
                "mesh's memory is written again");
  if (outcome.needed_slots > static_cast<unsigned long long>(task.output.slot_capacity))
    throw Error(ErrorCode::limit, "cuda: the output has room for " + std::to_string(task.output.slot_capacity) +
                                      " tiles, " + std::to_string(outcome.needed_slots) +
                                      " are needed; nothing was written, give it more");
  throw Error(ErrorCode::limit, "cuda: the triangle lists need room for at least " +
                                    std::to_string(outcome.needed_entries) +
                                    " entries; nothing was written, give a workspace for more (workspace_bytes)");
} catch (...) {
  throw_as_error("cuda");
}

std::int64_t likely_entries(const BatchTask& task) try {
  check_sizes(task);
  const Grid all = stacked_grid(task);
  return task.count == 0 ? 0 : estimate_list_entries(task.triangle_count, all, all.max_spacing());
} catch (...) {
  throw_as_error("cuda");
}

void check(const Outcome& outcome, const BatchTask&) try { check(outcome, Task{}); } catch (...) {
  throw_as_error("cuda");
}

}  // namespace standoff::cuda
