// SPDX-License-Identifier: Apache-2.0
// Fields with steps left out, to measure what these cost (Table 5.4 of the thesis): the product's kernels with other
// steps.
#pragma once

#include <type_traits>

#include "thesis/algorithm_1.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// The field is computed, but not written.
struct StepsToDistance : AllSteps {
  static constexpr bool kWrites = false;
  static STANDOFF_DEVICE bool uses(float value) { return __float_as_uint(value) == kNeverBits; }
};
/// The samples to measure from are found, and counted.
struct StepsToRows : StepsToDistance {
  static constexpr bool kMeasures = false;
};
/// Triangles are set up, and a number of them is read.
struct StepsToSetUp : StepsToRows {
  static constexpr bool kFindsRows = false;
};
/// Lists are walked through.
struct StepsToLists : StepsToSetUp {
  static constexpr bool kSetsUp = false;
};

template <StopAfter kLast>
using StepsTo = std::conditional_t<
    kLast == StopAfter::lists, StepsToLists,
    std::conditional_t<
        kLast == StopAfter::set_up, StepsToSetUp,
        std::conditional_t<kLast == StopAfter::rows, StepsToRows,
                           std::conditional_t<kLast == StopAfter::distance, StepsToDistance, AllSteps>>>>;

/// enqueue() with all after a step left out: of thin bands and of Algorithm 1; other fields are whole. Requires a task
/// that enqueue() takes.
template <StopAfter kLast>
void enqueue_until(const Task& task, void* workspace, std::int64_t bytes, Stream stream) {
  const Lattice l = make_lattice(task.grid, task.thickness);
  if (task.method == Method::thesis) {
    const auto algorithm = in_workspace<Algorithm1>(task, l, workspace, bytes);
    algorithm.template lower<kLast>(l, task, stream);
    algorithm.write(l, task, stream);
  } else if (is_thin(task.grid, task.thickness)) {
    const auto band = in_workspace<ThinBand>(task, l, workspace, bytes);
    band.count(l, task, stream);
    band.template fill<StepsTo<kLast>>(l, task, stream);
  } else {
    in_workspace<ThickBand>(task, l, workspace, bytes).enqueue(l, task, stream);
  }
}

}  // namespace standoff::STANDOFF_PLATFORM
