// SPDX-License-Identifier: Apache-2.0
// The layers of a drawing as parts, and the numbers that they show.
#pragma once

#include <limits>
#include <vector>

#include "render/part.h"
#include "standoff/picture.h"

namespace standoff {

/// The finite numbers that a drawing turns into colors.
struct NumberRange {
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  double thickness = least;  ///< of the fields: numbers of this magnitude stand for all beyond

  bool empty() const { return !(least <= greatest); }
  void include(double value) {
    if (!std::isfinite(value)) return;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
};
NumberRange number_range(const Drawing& drawing);

/// Throws Error{usage} or Error{input} for a drawing that cannot be drawn.
void check(const Drawing& drawing);
/// The box around everything drawn; empty if there is nothing.
Box bounds_of(const Drawing& drawing, const std::vector<std::vector<char>>& unused);

/// The plane of the samples that a slice shows, along its axis, world units.
double position_of(const SliceLayer& slice);

/// What the other layers than meshes become. `pixel` is about the width of a pixel in the unit space.
void add_slices(const Drawing& drawing, const UnitSpace& space, std::vector<DrawnPart>& parts);
void add_bands(const Drawing& drawing, const UnitSpace& space, float pixel, std::vector<DrawnPart>& parts);
void add_points(const Drawing& drawing, const UnitSpace& space, float pixel, std::vector<DrawnPart>& parts);
void add_paths(const Drawing& drawing, const UnitSpace& space, float pixel, std::vector<DrawnPart>& parts);
void add_boxes(const Drawing& drawing, const UnitSpace& space, float pixel, std::vector<DrawnPart>& parts);
/// Lines along edges of a part, given by their ends.
DrawnPart edge_lines(const DrawnPart& part, std::span<const std::array<std::uint32_t, 2>> edges, float pixel);

/// About how many bytes the parts of a drawing take, before they are made; without the lines along edges.
std::size_t bytes_of_parts(const Drawing& drawing, const UnitSpace& space, float pixel);
std::size_t bytes_of_lines(std::size_t edges);

}  // namespace standoff
