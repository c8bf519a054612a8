// SPDX-License-Identifier: Apache-2.0
#include "computed.h"

#include "options.h"

namespace standoff::python {

Method method_of(const std::string& name) { return row_of("method", name, kComputeMethods).method; }

nb::dict dict_of(const ComputeReport& r, double seconds) {
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
