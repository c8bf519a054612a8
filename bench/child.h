// SPDX-License-Identifier: Apache-2.0
// Runs a job that may take far too long in its own process, which can be stopped.
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace standoff::bench {

/// Runs the job in a copy of this process, made by fork, and returns its result; nothing if it took more than `limit_s`
/// seconds of processor time. An error of the job goes to stderr; an error or a crash becomes a runtime_error here.
std::optional<std::vector<double>> run_in_child(double limit_s, const std::function<std::vector<double>()>& job);

}  // namespace standoff::bench
