// SPDX-License-Identifier: Apache-2.0
#include "io/field/samples.h"

#include <algorithm>
#include <bit>
#include <vector>

namespace standoff {
namespace {

static_assert(std::endian::native == std::endian::little, "field files are written as the machine holds numbers");

constexpr std::int64_t kSide = DistanceField::kTileSide;

// Slices held at a time: a layer of tiles, or fewer when slices are large.
std::int64_t slices_at_once(const Grid& grid) {
  constexpr std::int64_t kSamples = std::int64_t{1} << 20;
  return std::clamp<std::int64_t>(kSamples / (grid.size.x * grid.size.y), 1, kSide);
}

template <class Sample, class Copy>
void send(const Grid& grid, Copy copy, const ByteSink& sink) {
  const std::int64_t plane = grid.size.x * grid.size.y, step = slices_at_once(grid);
  std::vector<Sample> slices(static_cast<std::size_t>(plane * std::min(step, grid.size.z)));
  for (std::int64_t k = 0; k < grid.size.z; k += step) {
    const std::int64_t count = std::min(step, grid.size.z - k);
    const auto part = std::span(slices).first(static_cast<std::size_t>(plane * count));
    copy(k, count, part);
    sink(std::as_bytes(part));
  }
}

}  // namespace

std::uint64_t sample_bytes(const Grid& grid) {
  // Valid grids count up to 2^62 samples; no file is that long, whatever a header says.
  return 4 * static_cast<std::uint64_t>(std::min(grid.sample_count(), std::int64_t{1} << 61));
}

void send_values(const DistanceField& field, const ByteSink& sink) {
  send<float>(
      field.grid(), [&](auto k, auto count, auto out) { field.copy_slices(k, count, out); }, sink);
}

void send_nearest(const DistanceField& field, const ByteSink& sink) {
  send<std::uint32_t>(
      field.grid(), [&](auto k, auto count, auto out) { field.copy_nearest_slices(k, count, out); }, sink);
}

}  // namespace standoff
