// A job that may take far too long: in a process of its own, which is stopped.
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace difi::bench {

/// Runs the job in a copy of this process, made by fork, and returns what it returned; nothing where it needed more
/// than so many seconds (rounded up) of processor time. Errors of the job and crashes are thrown on as they are told.
std::optional<std::vector<double>> run_in_child(double limit_s, const std::function<std::vector<double>()>& job);

}  // namespace difi::bench
