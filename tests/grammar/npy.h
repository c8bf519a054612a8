// SPDX-License-Identifier: Apache-2.0
// Arrays of NumPy.
#pragma once

#include <string>

#include "tests/grammar/choices.h"

namespace standoff::grammar {

/// The bytes of a .npy file: `type` and `shape` as NumPy writes them, "<f8" and "(3, 2)".
std::string npy_array(Choices& c, const std::string& type, const std::string& shape, bool fortran, std::string bytes);

}  // namespace standoff::grammar
