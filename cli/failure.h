// SPDX-License-Identifier: Apache-2.0
// From exceptions to exit codes and what the user is told.
#pragma once

#include <functional>

namespace standoff::cli {

/// Runs the program and returns its exit code: 0, or what ErrorCode says for an exception, after one line on stderr of
/// the form `standoff: error: what; what to do`.
int exit_code_of(const std::function<void()>& run);

}  // namespace standoff::cli
