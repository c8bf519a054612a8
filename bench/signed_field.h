// SPDX-License-Identifier: Apache-2.0
// The signed field of a workload, which surfaces are made of and files hold.
#pragma once

#include "standoff/compute.h"
#include "workload.h"

namespace standoff::bench {

inline DistanceField signed_field(const Workload& work, bool nearest = false) {
  ComputeOptions options;
  options.sign.method = SignMethod::winding;
  options.nearest_triangle = nearest;
  options.execution = {.threads = work.threads, .backend = Backend::cpu};
  DistanceField field;
  compute_into(work.mesh, work.grid, work.thickness, field, options);
  return field;
}

}  // namespace standoff::bench
