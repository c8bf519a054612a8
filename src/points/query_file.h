// SPDX-License-Identifier: Apache-2.0
// Queries in files, for read_query() and for the fuzzer, whose changed bytes would end at the checksum.
#pragma once

#include "files/array_file.h"
#include "standoff/points.h"

namespace standoff {

/// The query in a file's bytes. Errors: input.
MeshQuery read_query_file(const FileView& file, ArrayChecksum checksum);

}  // namespace standoff
