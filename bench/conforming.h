// SPDX-License-Identifier: Apache-2.0
// Bodies made by code whose surfaces run side by side, or hold on to each other: the hard pairs of collision queries.
#pragma once

#include <cstdint>
#include <string>

#include "standoff/mesh.h"

namespace standoff::bench {

/// Whether make_conforming() knows the name.
bool is_conforming(const std::string& name);

/// `triangles` = 0 takes the body's own count. What names a clearance has it as its number, as in `sleeve:0.001`.
/// Throws invalid_argument for a name that is not known.
///
/// | name | is |
/// |---|---|
/// | shell:R | a ball of radius R that is hollow: its wall is 1 % thick |
/// | plate | 10 long and wide, 0.1 thick, its top at y = 0 |
/// | shaft | a cylinder about the y axis, radius 1, 6 long |
/// | sleeve:C | a tube around the shaft, C away from it |
/// | bolt | a thread about the y axis, its pitch 0.5 and its height 0.1, open at the ends |
/// | nut:C | a ring around the bolt, C away from it, as is measured along the radius |
/// | gear | 24 teeth around the y axis, 10.6 across |
/// | knot | a tube, 0.35 thick, along the torus knot (2, 3) |
/// | chain:N | six links; N = 0: the first, third, fifth of eleven, and so on; 1: the five between them |
/// | fan:N | slender triangles around one corner, the origin; it opens upwards, downwards if N is negative |
/// | stack | one triangle again and again |
/// | glove:D:FILE | the surface at distance D, in parts of the longest side, around a mesh that is 100 long |
Mesh make_conforming(const std::string& name, std::int64_t triangles);

}  // namespace standoff::bench
