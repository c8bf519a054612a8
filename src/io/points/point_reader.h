// SPDX-License-Identifier: Apache-2.0
// Points from files, a block at a time: files may hold more than memory does. One file here per format.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "standoff/vec.h"

namespace standoff {

/// What to make of points with a coordinate that is NaN, infinite or beyond kMaxCoordinate.
enum class InvalidPoints {
  reject,  ///< an error that names the first of them
  mark,    ///< all their coordinates become NaN
};

class PointReader {
 public:
  PointReader() = default;
  PointReader(const PointReader&) = delete;
  PointReader& operator=(const PointReader&) = delete;
  virtual ~PointReader() = default;

  /// Reads the next points, as many as there is room for: fewer at the end alone. Errors: input, as `FILE:WHERE: what;
  /// what to do`.
  virtual std::size_t read(std::span<Vec3> points) = 0;
  /// How many points there are in all, where that is known before they are read.
  virtual std::optional<std::uint64_t> count() const { return std::nullopt; }
  /// The share that was read, 0 to 1; 0 where the end is unknown.
  virtual double fraction() const = 0;
};

/// Opens a file of points. Its content decides the format; "-" is text from the standard input. The names of formats
/// are in docs/formats.md. Errors: input.
std::unique_ptr<PointReader> open_points(const std::string& name, InvalidPoints invalid);

}  // namespace standoff
