// SPDX-License-Identifier: Apache-2.0
// A job that may take far too long: in a process of its own, which is stopped.
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace standoff::bench {

/// Runs the job in a copy of this process, made by fork, and returns what it returned; nothing where it took more than
/// so many seconds of processor time. An error of the job goes to stderr; it and a crash end in a runtime_error here.
std::optional<std::vector<double>> run_in_child(double limit_s, const std::function<std::vector<double>()>& job);

}  // namespace standoff::bench
