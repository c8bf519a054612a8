// SPDX-License-Identifier: Apache-2.0
// Small meshes and fields for grammars to write.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/grammar/file.h"

namespace standoff::grammar {

/// Points that are floats, and polygons over them that every triangulation but the fan of their first corner would
/// bend: convex, flat. At least one has three corners or more.
struct Shape {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
};

enum class Polygons { none, some };

/// `extreme` allows numbers from the smallest float to the largest, and polygons that hold only where nothing is
/// rounded.
Shape make_shape(Choices& c, Polygons polygons, bool extreme);

/// Appends the triangles a reader must make of the faces.
void add_triangles(const Shape& shape, std::vector<Corners>& to);

/// A coordinate: of a lattice, so that points meet, or any.
float make_coordinate(Choices& c, bool extreme);

/// A grid of up to some thousand samples, a thickness, values up to it, sometimes nearest triangles.
Truth make_field(Choices& c, bool may_have_nearest);
/// Shortest decimals of a double; at a trick something else.
std::string real64(Choices& c, double value);

}  // namespace standoff::grammar
