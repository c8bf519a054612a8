// SPDX-License-Identifier: Apache-2.0
// What every fuzzer of a field reader does.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "io/field/format.h"
#include "standoff/error.h"

namespace standoff {

/// Reads bytes as a file: an error or a field whose values keep its promise, nothing else.
inline int fuzz_field(DistanceField (*read)(const FileView&, std::int64_t), const std::uint8_t* data,
                      std::size_t size) {
  const FileView view("fuzz", {reinterpret_cast<const char*>(data), size});
  try {
    const DistanceField field = read(view, 0);
    if (!(field.thickness() > 0)) std::abort();
    for (const float value : field.to_dense())
      if (!(std::abs(value) <= static_cast<float>(field.thickness()))) std::abort();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input && error.code() != ErrorCode::limit) std::abort();
  }
  return 0;
}

}  // namespace standoff
