// SPDX-License-Identifier: Apache-2.0
#include "tests/support/paths.h"

namespace standoff {

const char* const kSourceFolder = STANDOFF_SOURCE_DIR;
const char* const kBinaryFolder = STANDOFF_BINARY_DIR;
const char* const kPython = STANDOFF_PYTHON;

}  // namespace standoff
