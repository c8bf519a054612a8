// SPDX-License-Identifier: Apache-2.0
// What the methods that decide a sign have in common: for each row of tiles they say which samples are inside.
#pragma once

#include <cstdint>

#include "sign/inside_rows.h"

namespace standoff {

class Sides {
 public:
  Sides() = default;
  Sides(const Sides&) = delete;
  Sides& operator=(const Sides&) = delete;
  virtual ~Sides() = default;

  /// Marks the samples that are inside in the tiles (., ty, tz). `rows` has been cleared for these tiles. Many threads
  /// call it at once, each with rows of its own.
  virtual void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const = 0;
};

}  // namespace standoff
