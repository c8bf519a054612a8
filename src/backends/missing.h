// SPDX-License-Identifier: Apache-2.0
// What all tables say alike of backends: which one Backend::automatic may take, and why one is not there.
#pragma once

#include <string>

#include "gpu/devices.h"
#include "standoff/error.h"
#include "standoff/execution.h"
#include "standoff/testing/emulation.h"

namespace standoff {

/// What Backend::automatic takes where it is there and the work is large enough.
inline constexpr Backend kAutomaticGpu = Backend::cuda;

/// Throws Error{device} for a backend that this build or this machine may lack; `where` is the call.
inline void throw_if_missing(Backend backend, const char* where) {
  if (backend == Backend::cuda) throw Error(ErrorCode::device, cuda::why_not_available());
  if (backend == testing::kEmulated)
    throw Error(ErrorCode::device, std::string(where) +
                                       ": this build of standoff has no emulated GPU; use the CPU, or build standoff "
                                       "with the component 'emulation' (STANDOFF_COMPONENTS)");
}

/// The row of a table of devices that the backend names; nullptr where the CPU does the work. `is_small`: automatic
/// leaves it to the CPU. Throws Error{device} where the named one is missing.
template <class Rows>
auto find_device_row(const Rows& rows, Backend backend, bool is_small, const char* where) -> decltype(rows.data()) {
  const bool automatic = backend == Backend::automatic;
  if (automatic && is_small) return nullptr;
  for (const auto& row : rows)
    if (row.backend == (automatic ? kAutomaticGpu : backend) && row.available()) return &row;
  throw_if_missing(backend, where);
  return nullptr;
}

}  // namespace standoff
