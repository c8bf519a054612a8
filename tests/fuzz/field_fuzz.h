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
inline int fuzz_field(FieldFile (*read)(const FileView&, const FieldRequest&), const std::uint8_t* data,
                      std::size_t size) {
  const FileView view("fuzz", {reinterpret_cast<const char*>(data), size});
  try {
    // A tree of few bytes may span a grid of many samples.
    const FieldFile file = read(view, {.memory_limit = std::int64_t{64} << 20});
    const DistanceField& field = file.field;
    for (const Sidecar& sidecar : file.sidecars) {
      const std::size_t numbers = std::visit([](const auto& values) { return values.size(); }, sidecar.values);
      if (numbers != field.tile_values().size() * static_cast<std::size_t>(sidecar.components)) std::abort();
    }
    if (!(field.thickness() > 0)) std::abort();
    for (const float value : field.tile_values())
      if (!(std::abs(value) <= static_cast<float>(field.thickness()))) std::abort();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input && error.code() != ErrorCode::limit) std::abort();
  }
  return 0;
}

}  // namespace standoff
