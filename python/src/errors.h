// SPDX-License-Identifier: Apache-2.0
// The exceptions of standoff/_errors.py for errors that are answers, not thrown.
#pragma once

#include "common.h"
#include "standoff/error.h"

namespace standoff::python {

/// The exception, with the data of the error's details.
nb::object exception_of(const Error& error);

}  // namespace standoff::python
