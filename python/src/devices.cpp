// SPDX-License-Identifier: Apache-2.0
// GPUs.
#include "common.h"
#include "standoff/cuda.h"

namespace standoff::python {

void add_devices(nb::module_& m) {
  m.def("devices", [] {
    std::vector<nb::dict> all;
    for (const cuda::DeviceInfo& device : cuda::devices()) {
      nb::dict d;
      d["name"] = device.name;
      d["capability"] = nb::make_tuple(device.major, device.minor);
      d["memory_bytes"] = device.memory_bytes;
      all.push_back(std::move(d));
    }
    return all;
  });
  m.def("why_no_device", &cuda::why_no_device);
}

}  // namespace standoff::python
