// SPDX-License-Identifier: Apache-2.0
// What the methods that decide a sign have in common: for each row of tiles they say which samples are inside.
#pragma once

#include <cstdint>
#include <limits>

#include "sign/inside_rows.h"

namespace standoff {

class Sides {
 public:
  Sides() = default;
  Sides(const Sides&) = delete;
  Sides& operator=(const Sides&) = delete;
  virtual ~Sides() = default;

  /// Called before fill(), by one thread, with the number of a row of tiles, ty + tiles_y * tz: first 0, then what it
  /// returned. Until it is called again fill() is called for rows of tiles from `first` to before the number returned.
  /// So what is held at a time can be bounded. Runs on the threads of the calling TBB arena.
  virtual std::int64_t load([[maybe_unused]] std::int64_t first) { return std::numeric_limits<std::int64_t>::max(); }

  /// Marks the samples that are inside in the tiles (., ty, tz). `rows` has been cleared for these tiles. Many threads
  /// call it at once, each with rows of its own. Where a row of tiles may take long, throws Error{interrupted}.
  virtual void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const = 0;
};

}  // namespace standoff
