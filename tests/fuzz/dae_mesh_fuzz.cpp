// SPDX-License-Identifier: Apache-2.0
#include "mesh_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto read = [](const standoff::FileView& file) {
    standoff::MeshReadReport report;
    return standoff::read_dae(file, report);
  };
  return standoff::fuzz_mesh(read, data, size);
}
