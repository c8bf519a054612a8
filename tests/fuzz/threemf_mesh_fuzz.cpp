// SPDX-License-Identifier: Apache-2.0
#include "mesh_fuzz.h"
#include "tests/support/stored_zip.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto read = [](const standoff::FileView& file) {
    standoff::MeshReadReport report;
    return standoff::read_3mf(file, report);
  };
  // Checksums keep damaged models from their reader, so it also gets the bytes themselves.
  const std::string archive = standoff::stored_zip({{"3D/3dmodel.model", {reinterpret_cast<const char*>(data), size}}});
  standoff::fuzz_mesh(read, reinterpret_cast<const std::uint8_t*>(archive.data()), archive.size());
  return standoff::fuzz_mesh(read, data, size);
}
