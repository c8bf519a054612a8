// SPDX-License-Identifier: Apache-2.0
#include "sign/flood/lattice.h"

#include <algorithm>
#include <cmath>

#include "core/tile_count.h"

namespace standoff {
namespace {

// The grid's tiles along one axis, and the extent of the box there.
struct TileSpan {
  GridAxis axis;     // with all samples of its tiles
  double low, high;  // of the box

  double samples_to(double value) const { return (value - axis.at(0)) / axis.spacing; }
  LatticeAxis with(const LatticeAxis::Margin& margin) const { return {axis, margin}; }
};

// An estimate of the tiles that evenly spaced samples need along the axis: a double, because they may be too many to
// count.
double tiles_needed(const TileSpan& span) {
  const double first = std::max(0.0, -span.samples_to(span.low)),
               past = std::max(static_cast<double>(span.axis.size), span.samples_to(span.high));
  return (first + past) / kTileSide + 2;
}

// Whole tiles that certainly end within the box: the last tiles are then added one by one.
LatticeAxis::Margin most_of(const TileSpan& span) {
  const auto whole = [](double samples) {
    return kTileSide * std::max<std::int64_t>(0, static_cast<std::int64_t>(samples / kTileSide) - 1);
  };
  return {whole(-span.samples_to(span.low)), whole(span.samples_to(span.high) - static_cast<double>(span.axis.size)),
          false};
}

// Adds tiles on each side, at most `most`, until the outermost samples are outside the box. Returns whether they are.
bool reach_beyond(const TileSpan& span, std::int64_t most, LatticeAxis::Margin& margin) {
  const auto before = [&] { return span.with(margin).at(0) < span.low; };
  const auto after = [&] {
    const LatticeAxis axis = span.with(margin);
    return axis.at(axis.size() - 1) > span.high;
  };
  for (std::int64_t n = 0; n < most && !before(); ++n) margin.before += kTileSide;
  for (std::int64_t n = 0; n < most && !after(); ++n) margin.after += kTileSide;
  return before() && after();
}

LatticeAxis::Margin margin_around(const TileSpan& span, bool even) {
  // Give up even spacings where the rounding of coordinates hides them.
  constexpr std::int64_t kMostEven = 4, kMostDoubling = 300;
  if (even)
    if (LatticeAxis::Margin margin = most_of(span); reach_beyond(span, kMostEven, margin)) return margin;
  LatticeAxis::Margin margin{0, 0, true};
  reach_beyond(span, kMostDoubling, margin);  // beyond all numbers, if need be
  return margin;
}

TileLattice made_of(const std::array<TileSpan, 3>& spans, const std::array<LatticeAxis::Margin, 3>& margins) {
  const auto axis = [&](std::size_t n) { return spans[n].with(margins[n]); };
  TileLattice lattice{{axis(0), axis(1), axis(2)}, {}, {}};
  const auto tiles = [&](std::size_t n) { return lattice.axes[n].size() / kTileSide; };
  lattice.tiles = {tiles(0), tiles(1), tiles(2)};
  lattice.origin = {margins[0].before / kTileSide, margins[1].before / kTileSide, margins[2].before / kTileSide};
  return lattice;
}

std::array<TileSpan, 3> spans_of(const Grid& grid, const Box& box) {
  std::array<GridAxis, 3> axes = axes_of(grid);
  for (GridAxis& axis : axes) axis.size = kTileSide * tiles_along(axis.size);
  return {TileSpan{axes[0], box.min.x, box.max.x}, TileSpan{axes[1], box.min.y, box.max.y},
          TileSpan{axes[2], box.min.z, box.max.z}};
}

}  // namespace

LatticeAxis::LatticeAxis(const GridAxis& axis, const Margin& margin)
    : axis_(axis),
      per_spacing_(1 / axis.spacing),
      before_(margin.before),
      size_(margin.before + axis.size + margin.after),
      first_even_(margin.doubling ? margin.before : 0),
      last_even_(margin.doubling ? margin.before + axis.size - 1 : size_ - 1) {}

double LatticeAxis::doublings(std::int64_t samples) { return std::ldexp(1.0, static_cast<int>(samples)) - 1; }

TileLattice TileLattice::of(const Grid& grid) { return made_of(spans_of(grid, {}), {}); }

TileLattice TileLattice::around(const Grid& grid, const Box& box) {
  constexpr double kMostTimes = 8, kMostTiles = 0x1p18;
  const std::array<TileSpan, 3> spans = spans_of(grid, box);
  double needed = 1;
  for (const TileSpan& span : spans) needed *= tiles_needed(span);
  const bool even = needed <= std::max(kMostTimes * static_cast<double>(standoff::tile_count(grid.size)), kMostTiles);
  std::array<LatticeAxis::Margin, 3> margins;
  for (std::size_t n = 0; n < 3; ++n) margins[n] = margin_around(spans[n], even);
  return made_of(spans, margins);
}

}  // namespace standoff
