// SPDX-License-Identifier: Apache-2.0
// Closed solids, outward oriented. Each stands upright: its axis is the y axis of its frame, its base at y = 0 unless
// said otherwise. Lengths are in the scene's units; frames given to these functions are rigid or mildly scaled.
#pragma once

#include <span>
#include <vector>

#include "scenes/builder.h"

namespace standoff::scenes {

/// A point of a plane: of a profile (radius, height) or of an outline seen from above (x to the right, -z up).
struct Point2 {
  double u = 0, v = 0;
};

void box(Builder& b, const Frame& f, Vec3 low, Vec3 high);
/// A square-cut bar between two points; `width` is horizontal for bars that are not upright.
void beam(Builder& b, const Frame& f, Vec3 from, Vec3 to, double width, double height);

/// A profile turned about the y axis. It runs upwards on the outside, from the axis to the axis, or is a loop.
void lathe(Builder& b, const Frame& f, const std::vector<Point2>& profile, int sides, bool loop = false);
void cylinder(Builder& b, const Frame& f, double radius, double height, int least_sides = 8);
/// A cylinder between two points.
void rod(Builder& b, const Frame& f, Vec3 from, Vec3 to, double radius, int least_sides = 6);
void cone(Builder& b, const Frame& f, double bottom_radius, double top_radius, double height, int least_sides = 8);
/// A pipe wall: both surfaces and both annular ends.
void tube(Builder& b, const Frame& f, double outer, double inner, double height, int least_sides = 8);
void torus(Builder& b, const Frame& f, double radius, double thickness, int least_sides = 12);
void ellipsoid(Builder& b, const Frame& f, Vec3 radii, int least_sides = 8);
/// The quarter of a profile from the axis or to it that makes a dished end; `bulge` is its height.
void append_dome(std::vector<Point2>& profile, double radius, double y, double bulge, int pieces, bool top);

/// An outline, counterclockwise seen from above, raised from y = 0 to `height`. It may be concave.
void extrude(Builder& b, const Frame& f, const std::vector<Point2>& outline, double height);
/// A toothed wheel lying in the plane y = 0.
void gear(Builder& b, const Frame& f, double radius, double height, int teeth);

/// A round bar along a path. Interior corners are rounded with `bend`, ends are flat.
void pipe(Builder& b, const Frame& f, const std::vector<Vec3>& corners, double radius, double bend,
          int least_sides = 8);
/// A round bar along a smooth path whose radius changes; `radii` has one radius per point, or one for all.
void sweep(Builder& b, const Frame& f, const std::vector<Vec3>& path, const std::vector<double>& radii, int sides);
/// A skin over sections of equally many points, closed by flat or pointed ends. Sections run to the right seen from
/// outside with the next section above.
void loft(Builder& b, const Frame& f, const std::vector<std::vector<Vec3>>& sections, bool close_ends = true);

}  // namespace standoff::scenes
