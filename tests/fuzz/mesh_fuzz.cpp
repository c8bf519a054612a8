// SPDX-License-Identifier: Apache-2.0
// The fuzzer of a mesh reader. CMakeLists.txt makes one of it for each row of the table of formats, STANDOFF_FORMAT.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "io/mesh/format.h"
#include "standoff/error.h"
#include "tests/support/stored_zip.h"

namespace standoff {
namespace {

// Any bytes of a file give a valid mesh, Error{input}, or Error{limit} for what would unfold too far; anything else
// ends the process.
void read_bytes_as_mesh(std::string_view bytes) {
  try {
    MeshReadReport report;
    validate(STANDOFF_FORMAT.read(FileView("fuzzed", bytes), report));
  } catch (const Error& error) {
    const std::string_view message = error.what();
    const bool too_far = error.code() == ErrorCode::limit && message.find("its nodes place meshes") != message.npos;
    if ((error.code() != ErrorCode::input && !too_far) || !message.starts_with("fuzzed:")) std::abort();
  }
}

}  // namespace
}  // namespace standoff

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  standoff::read_bytes_as_mesh(bytes);
  // Checksums keep damaged models from their reader, so it also gets the bytes as a model in a good archive.
  if (standoff::STANDOFF_FORMAT.packed)
    standoff::read_bytes_as_mesh(standoff::stored_zip({{"3D/3dmodel.model", std::string(bytes)}}));
  return 0;
}
