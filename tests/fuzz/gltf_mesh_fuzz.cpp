#include "mesh_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return difi::fuzz_mesh(difi::read_gltf, data, size);
}
