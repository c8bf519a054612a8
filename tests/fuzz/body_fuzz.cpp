// SPDX-License-Identifier: Apache-2.0
// Any bytes give a body or Error{input}; of a body, whatever bounds it holds, queries end and stay inside its arrays.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "tests/support/ask_body.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto error = standoff::ask(standoff::read_body({reinterpret_cast<const char*>(data), size}));
    if (error && *error != standoff::ErrorCode::usage) std::abort();
  } catch (const standoff::Error& error) {
    if (error.code() != standoff::ErrorCode::input || !std::string_view(error.what()).starts_with("fuzzed:"))
      std::abort();
  }
  return 0;
}
