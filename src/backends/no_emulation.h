// SPDX-License-Identifier: Apache-2.0
// The error of a build without the emulated GPU.
#pragma once

#include <string>

#include "standoff/error.h"

namespace standoff {

/// Throws Error{device}; `where` names the call.
[[noreturn]] inline void throw_no_emulation(const char* where) {
  throw Error(ErrorCode::device, std::string(where) +
                                     ": this build of standoff has no emulated GPU; use the CPU, or build standoff "
                                     "with the component 'emulation' (STANDOFF_COMPONENTS)");
}

}  // namespace standoff
