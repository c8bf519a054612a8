// SPDX-License-Identifier: Apache-2.0
#include "grammar_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return standoff::grammar::fuzz_one_of({"dae", "3ds"}, data, size);
}
