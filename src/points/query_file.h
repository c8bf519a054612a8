// SPDX-License-Identifier: Apache-2.0
// Queries in files, for MeshQuery::load(), and for the fuzzer: its bytes never match the checksum, so it ignores that.
#pragma once

#include "files/array_file.h"
#include "standoff/points.h"

namespace standoff {

/// Reads a query. Throws Error{input}.
MeshQuery read_query_file(const FileView& file, ArrayChecksum checksum);

}  // namespace standoff
