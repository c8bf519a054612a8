// SPDX-License-Identifier: Apache-2.0
// The compiled part of the package: standoff._core. Users call what standoff/__init__.py names, which checks and
// converts; nothing here has defaults.
#include "common.h"
#include "standoff/version.h"

NB_MODULE(_core, m) {
  using namespace standoff::python;
  m.attr("version") = STANDOFF_VERSION;
  add_errors(m);
  add_meshes(m);
  add_fields(m);
  add_queries(m);
  add_surfaces(m);
  add_bodies(m);
  add_reports(m);
  add_pictures(m);
  add_devices(m);
}
