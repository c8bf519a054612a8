// SPDX-License-Identifier: Apache-2.0
// What every mesh fuzzer asks of its reader.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "io/mesh/format.h"
#include "standoff/error.h"

namespace standoff {

/// Any bytes of a file called `name` give a valid mesh, Error{input}, or Error{limit} for what would unfold too far;
/// anything else ends the process.
inline int fuzz_mesh(Mesh (*read)(const FileView&), const std::uint8_t* data, std::size_t size,
                     const std::string& name = "fuzzed") {
  if (size == 0) return 0;
  try {
    validate(read(FileView(name, std::string_view(reinterpret_cast<const char*>(data), size))));
  } catch (const Error& error) {
    const std::string_view message = error.what();
    const bool too_far = error.code() == ErrorCode::limit && message.find("its nodes place meshes") != message.npos;
    if ((error.code() != ErrorCode::input && !too_far) || !message.starts_with(name + ":")) std::abort();
  }
  return 0;
}

}  // namespace standoff
