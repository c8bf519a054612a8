// SPDX-License-Identifier: Apache-2.0
// Where the tests find what they run and read. Told by CMake to one file alone: all the others compile alike in every
// folder, so that a compiler cache serves all checkouts and builds.
#pragma once

namespace standoff {

extern const char* const kSourceFolder;  ///< the checkout
extern const char* const kBinaryFolder;  ///< the build folder, where the program lies
extern const char* const kPython;        ///< the Python that has Debian's packages

}  // namespace standoff
