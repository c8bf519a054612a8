// SPDX-License-Identifier: Apache-2.0
// How much memory a field takes, and the error of a limit that is too small.
#pragma once

#include <string>

#include "standoff/error.h"

namespace standoff {

/// Bytes that a DistanceField takes with so many tiles stored, of so many in its grid.
double field_bytes(double stored_tiles, double all_tiles, bool with_nearest);

/// "161 MiB, more than the limit of 160 MiB": requires needed > limit, and shows it.
std::string over_the_limit(double needed, double limit);
/// The same as data.
ErrorDetails limit_details(double needed, double limit);

}  // namespace standoff
