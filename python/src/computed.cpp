// SPDX-License-Identifier: Apache-2.0
#include "computed.h"

#include "options.h"

namespace standoff::python {

Method method_of(const std::string& name) { return row_of("method", name, kComputeMethods).method; }

ComputeOptions compute_options(const nb::handle& sign, const std::string& method, bool nearest, int threads,
                               const std::string& device, std::int64_t memory_limit) {
  ComputeOptions options{.method = method_of(method), .sign = sign_of(sign), .execution = {.threads = threads}};
  options.devices = devices_in(device, options.execution.backend);
  options.memory_limit = memory_limit;
  options.nearest = nearest;
  return options;
}

nb::dict computation_dict(const ComputeReport& r, double seconds) {
  nb::dict d;
  d["method"] = r.method;
  d["backend"] = r.backend;
  d["device"] = r.device;
  d["threads"] = r.threads;
  d["triangles"] = r.triangles;
  d["samples_examined"] = r.samples_examined;
  d["samples_band"] = r.samples_band;
  d["seconds"] = seconds;
  d["sign"] = sign_dict(r.sign);
  d["provenance"] = r.provenance;
  return d;
}

}  // namespace standoff::python
