// SPDX-License-Identifier: Apache-2.0
#include "mesh_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return standoff::fuzz_mesh(standoff::read_medit, data, size);
}
