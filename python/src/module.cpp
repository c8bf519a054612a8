// SPDX-License-Identifier: Apache-2.0
// The compiled part of the package: standoff._core. Users call what standoff/__init__.py names, which checks and
// converts; nothing here has defaults.
#include "common.h"
#include "standoff/cuda.h"
#include "standoff/version.h"

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

NB_MODULE(_core, m) {
  using namespace standoff::python;
  m.attr("version") = STANDOFF_VERSION;
  // Daemon threads that die with the interpreter leak what they work with; that is for developers to know.
  nb::set_leak_warnings(nb::cast<bool>(nb::module_::import_("sys").attr("flags").attr("dev_mode")));
  add_errors(m);
  add_meshes(m);
  add_fields(m);
  add_windows(m);
  add_stores(m);
  add_updates(m);
  add_queries(m);
  add_surfaces(m);
  add_bodies(m);
  add_reports(m);
  add_pictures(m);
  add_pages(m);
  add_devices(m);
  add_device_arrays(m);
}
