// SPDX-License-Identifier: Apache-2.0
// Fields with steps left out, to measure what these cost (Table 5.4 of the thesis): the product's kernels with other
// steps.
#pragma once

#include <type_traits>

#include "thesis/algorithm_1.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// The field is computed, but not written.
struct StepsToDistance : AllSteps {
  static STANDOFF_DEVICE bool writes(float value) { return __float_as_uint(value) == kNeverBits; }
};
/// Warps choose their triangles, but do not measure to them.
struct StepsToVote : StepsToDistance {
  template <bool kNearest>
  static STANDOFF_DEVICE void measure(const Stage&, int, std::uint32_t, const Triple<float>&, Nearest&) {}
};
/// Triangles are set up, and a number of them is read.
struct StepsToSetUp : StepsToVote {
  template <bool kNearest, class Steps>
  static STANDOFF_DEVICE int gather_stage(const Lattice&, const Stage& stage, int count, const Triple<float>&,
                                          const Triple<float>&, bool, float, Nearest&) {
    const float number = stage.setup[threadIdx.x % Stage::kTriangles].number[count % 32];
    return __float_as_uint(number) == kNeverBits;
  }
};
/// Lists are walked through.
struct StepsToLists : StepsToSetUp {
  static STANDOFF_DEVICE void set_up(const Lattice&, const DeviceMesh&, std::uint32_t, const Triple<double>&, Stage&,
                                     int) {}
};

template <StopAfter kLast>
using StepsTo = std::conditional_t<
    kLast == StopAfter::lists, StepsToLists,
    std::conditional_t<
        kLast == StopAfter::set_up, StepsToSetUp,
        std::conditional_t<kLast == StopAfter::vote, StepsToVote,
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
