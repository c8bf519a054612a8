#include "mesh_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto read = [](const difi::FileView& file) { return difi::read_with_assimp(file, "dae"); };
  return difi::fuzz_mesh(read, data, size, "fuzzed.dae");
}
