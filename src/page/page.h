// SPDX-License-Identifier: Apache-2.0
// Fields as pages hold them.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "standoff/page.h"

namespace standoff::page {

/// Whole numbers that stand for a field's values. What is finite lies within kMostCode.
inline constexpr std::int32_t kMostCode = 32766;
inline constexpr std::int32_t kInfiniteCode = 32767;  ///< and its negative
inline constexpr std::int32_t kNoNumberCode = -32768;

/// A field of which every `every`-th sample per axis is left, and its values in steps.
struct CodedField {
  Grid grid;
  std::int64_t every = 1;
  double step = 1;                                       ///< world units; a code times this is the value
  std::int32_t clamped = 0;                              ///< the code of the thickness; 0 where no value is clamped
  double min = std::numeric_limits<double>::infinity();  ///< of all values of the field, world units
  double max = -std::numeric_limits<double>::infinity();
  std::string tiles;                   ///< a byte for each tile of the grid, x fastest: 0 outside, 1 inside, 2 stored
  std::int64_t stored = 0;             ///< how many are stored
  std::vector<std::int32_t> codes;     ///< 512 of each stored tile, x fastest; beyond the grid anything
  std::vector<std::uint32_t> nearest;  ///< the same for nearest triangles; empty: none
};

CodedField coded_field(const DistanceField& field, const PageOptions& options);
/// Fills `held`, unless null.
std::string field_blob(const PageField& field, const PageOptions& options, PageItem* held);

}  // namespace standoff::page
