// SPDX-License-Identifier: Apache-2.0
// The signed field of a workload, for surfaces and files.
#pragma once

#include "standoff/compute.h"
#include "workload.h"

namespace standoff::bench {

inline ComputeOptions signed_options(const Workload& work) {
  return {.sign = {.method = SignMethod::winding}, .execution = {.threads = work.threads, .backend = Backend::cpu}};
}

inline DistanceField signed_field(const Workload& work, bool nearest = false) {
  ComputeOptions options = signed_options(work);
  options.nearest = nearest;
  DistanceField field;
  compute_into(work.mesh, work.grid, work.thickness, field, options);
  return field;
}

}  // namespace standoff::bench
