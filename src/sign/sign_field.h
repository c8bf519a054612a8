// SPDX-License-Identifier: Apache-2.0
// Signs of values: goes through the rows of tiles of a grid once, and negates values or collects bits where samples are
// inside. SignMethod::shell alone changes magnitudes.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "sign/signs.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/sign.h"

namespace standoff {

/// Calls use(rows, ty, tz) for each row of tiles of a window, which is a part of `grid`, that of the signs, in whole
/// tiles. Rows and tiles are counted in the grid. Runs on the threads of the calling TBB arena. Throws
/// Error{interrupted}.
template <class Use>
void for_each_row_of_tiles(SampleSigns& signs, bool invert, const Grid& grid, const Grid& window,
                           ProgressMeter& progress, const Use& use) {
  const std::int64_t tiles_y = tiles_along(grid.size.y), rows_y = tiles_along(window.size.y),
                     rows_z = tiles_along(window.size.z);
  const std::int64_t first_y = (window.first.y - grid.first.y) / kTileSide,
                     first_z = (window.first.z - grid.first.z) / kTileSide;
  const std::int64_t first = first_y + tiles_y * first_z, count = rows_y * rows_z;
  const auto number = [&](std::int64_t n) { return first + n % rows_y + tiles_y * (n / rows_y); };
  PerThread<InsideRows> scratch([&] { return InsideRows(grid, window); });
  for (std::int64_t next = 0; next < count;) {
    const std::int64_t loaded = signs.load(number(next));
    std::int64_t end = next + 1;
    if (loaded > number(count - 1)) end = count;
    while (end < count && number(end) < loaded) ++end;
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(next, end, 8), [&](const auto& range) {
      InsideRows& rows = scratch.local();
      for (std::int64_t n = range.begin(); n != range.end(); ++n) {
        progress.check();  // a range may be many rows
        const std::int64_t ty = first_y + n % rows_y, tz = first_z + n / rows_y;
        rows.clear(ty, tz);
        signs.fill(rows, ty, tz);
        if (invert) rows.invert();
        use(rows, ty, tz);
      }
    });
    next = end;
  }
}
/// The same for all rows of the grid.
template <class Use>
void for_each_row_of_tiles(SampleSigns& signs, bool invert, const Grid& grid, ProgressMeter& progress, const Use& use) {
  for_each_row_of_tiles(signs, invert, grid, grid, progress, use);
}

/// One bit for each sample of a grid. Rows along x, y before z; each begins with a new byte, its first sample in the
/// lowest bit.
struct SampleBits {
  Size3 size;
  std::vector<std::uint8_t> bytes;

  explicit SampleBits(const Size3& samples)
      : size(samples), bytes(static_cast<std::size_t>(row_bytes() * samples.y * samples.z)) {}

  std::int64_t row_bytes() const { return (size.x + 7) / 8; }
  bool operator()(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return (bytes[static_cast<std::size_t>((k * size.y + j) * row_bytes() + i / 8)] >> (i % 8) & 1) != 0;
  }
};

/// Which samples are inside. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
SampleBits bits_of(SampleSigns& signs, bool invert, const Grid& grid, ProgressMeter& progress);

/// Negates the values inside. A tile that is not stored is marked as inside, or is stored if it has samples on both
/// sides. The field's grid is that of the signs, or a window of it in whole tiles. Runs on the threads of the calling
/// TBB arena. Throws Error{interrupted}.
void sign_field(SampleSigns& signs, bool invert, const Grid& grid, DistanceField& field, ProgressMeter& progress);
/// The same for one value per sample, x fastest.
void sign_values(SampleSigns& signs, bool invert, const Grid& grid, std::span<float> values, ProgressMeter& progress);

/// Makes all values magnitudes again. Runs on the threads of the calling TBB arena.
void drop_signs(DistanceField& field);
void drop_signs(std::span<float> values);

/// A sheet as a solid: the distance to it, less half of the solid's thickness. World units.
class Shell {
 public:
  /// `thickness` is the thickness of the field. Requires SignMethod::shell and valid options.
  Shell(const SignOptions& options, double thickness)
      : half_(options.shell / 2),
        thickness_(thickness),
        reach_(static_cast<float>(thickness + half_)),
        invert_(options.invert) {}

  /// Distances must be known up to here, because the field's band lies on both sides of the solid's surface.
  static double reach(double shell, double thickness) { return thickness + shell / 2; }

  /// The field's value at a sample whose distance, at most the reach, was rounded to float. Rounds once more.
  float value(float distance) const {
    const double outwards = distance < reach_ ? distance - half_ : thickness_;
    return static_cast<float>(std::clamp(invert_ ? 0 - outwards : outwards, -thickness_, thickness_));
  }
  /// Whether a sample at a distance below the reach is deep inside the solid, and so no band sample.
  bool is_deep(float distance) const { return distance - half_ < -thickness_; }
  bool inverts() const { return invert_; }

 private:
  double half_, thickness_;
  float reach_;  // a backend writes this where the distance is larger
  bool invert_;
};

/// Changes a field of thickness t that was filled with distances up to Shell::reach. Tiles without a band sample are
/// then no longer stored. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
void apply(const Shell& shell, DistanceField& field, ProgressMeter& progress);
/// The same for one value per sample; `nearest` may be empty.
void apply(const Shell& shell, std::span<float> values, std::span<std::uint32_t> nearest, ProgressMeter& progress);

}  // namespace standoff
