// SPDX-License-Identifier: Apache-2.0
// The errors of DistanceField.
#pragma once

#include <cstdint>
#include <string>

#include "core/guarded.h"
#include "standoff/error.h"

namespace standoff {

/// Throws Error{usage} with the text that `message` returns. It is out of line, so that reading a sample needs no try
/// block; and `message` should capture by value, so that the caller's numbers can stay in registers.
template <class Message>
[[noreturn, gnu::cold, gnu::noinline]] void fail_field(Message message) try {
  throw Error(ErrorCode::usage, "field: " + std::string(message()));
} catch (...) {
  throw_as_error("field");
}

[[noreturn]] inline void fail_without_nearest() {
  fail_field([] { return "it holds no nearest triangles; compute it with them"; });
}

/// "(1,2,3)".
inline std::string index_text(std::int64_t x, std::int64_t y, std::int64_t z) {
  std::string text = "(";
  text.append(std::to_string(x)).append(",").append(std::to_string(y)).append(",").append(std::to_string(z));
  return text.append(")");
}

/// For functions that allocate: throws the exception being handled again, as an Error.
[[noreturn]] inline void throw_field_error() { throw_as_error("field", "take fewer samples, or provide more memory"); }

}  // namespace standoff
