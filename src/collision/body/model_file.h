// SPDX-License-Identifier: Apache-2.0
// Models in files, for load() and for the fuzzer, whose changed bytes would end at the checksum.
#pragma once

#include "files/array_file.h"
#include "standoff/collision.h"

namespace standoff::collision {

/// The model in a file's bytes. Errors: input.
CollisionModel read_model(const FileView& file, ArrayChecksum checksum);

}  // namespace standoff::collision
