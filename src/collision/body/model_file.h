// SPDX-License-Identifier: Apache-2.0
// Models in files, for load() and for the fuzzer, whose changed bytes would end at the checksum.
#pragma once

#include "files/file_view.h"
#include "standoff/collision.h"

namespace standoff::collision {

enum class BodyChecksum { checked, ignored };

/// The model in a file's bytes. Errors: input.
CollisionModel read_model(const FileView& file, BodyChecksum checksum);

}  // namespace standoff::collision
