// SPDX-License-Identifier: Apache-2.0
#include "tree_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return standoff::fuzz_tree("nvdb", standoff::read_nvdb, data, size);
}
