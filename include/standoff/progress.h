// SPDX-License-Identifier: Apache-2.0
// How work that takes long reports its progress, and how its caller cancels it.
#pragma once

#include <functional>

namespace standoff {

struct Progress {
  const char* stage = "";  ///< what is being done, in words for people: "preparing the mesh", "distances"; "done" at
                           ///< the end. That of reading and writing a file keeps a fraction of 0
  double fraction = 0;     ///< the finished share of the whole work, 0 to 1; never decreases
};

/// Called repeatedly, from one thread at a time. Return false to cancel: the call then throws Error{interrupted}. If
/// the callback throws, the work ends and the exception reaches the caller unchanged.
using ProgressCallback = std::function<bool(const Progress&)>;

}  // namespace standoff
