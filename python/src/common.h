// SPDX-License-Identifier: Apache-2.0
// What every file of the module includes.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstddef>
#include <cstdint>
#include <optional>

namespace standoff::python {

namespace nb = nanobind;
using namespace nb::literals;

// Each part of the module adds its functions and classes.
void add_errors(nb::module_& m);
void add_meshes(nb::module_& m);
void add_fields(nb::module_& m);
void add_windows(nb::module_& m);
void add_stores(nb::module_& m);
void add_updates(nb::module_& m);
void add_queries(nb::module_& m);
void add_surfaces(nb::module_& m);
void add_bodies(nb::module_& m);
void add_reports(nb::module_& m);
void add_pictures(nb::module_& m);
void add_pages(nb::module_& m);
void add_devices(nb::module_& m);
void add_device_arrays(nb::module_& m);

}  // namespace standoff::python
