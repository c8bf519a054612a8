// Bodies in files, for load() and for the fuzzer, whose changed bytes would end at the checksum.
#pragma once

#include "collision/body/model.h"
#include "files/file_view.h"

namespace standoff {

enum class BodyChecksum { checked, ignored };

}  // namespace standoff
