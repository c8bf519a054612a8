// SPDX-License-Identifier: Apache-2.0
// What computing a field takes and tells, wherever it runs.
#pragma once

#include <chrono>
#include <string>

#include "common.h"
#include "standoff/compute.h"

namespace standoff::python {

/// "tiles" or "thesis". Errors: usage.
Method method_of(const std::string& name);

/// What calls that compute a field share. Errors: usage.
ComputeOptions compute_options(const nb::handle& sign, const std::string& method, bool nearest, int threads,
                               const std::string& device, std::int64_t memory_limit);

/// The report for standoff/_compute.py; `seconds` is what the call took.
nb::dict dict_of(const ComputeReport& report, double seconds);

/// Writes the seconds from here to the end of the scope.
class Timed {
 public:
  explicit Timed(double& seconds) : seconds_(seconds) {}
  ~Timed() { seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count(); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

}  // namespace standoff::python
