// SPDX-License-Identifier: Apache-2.0
// Steelwork: what holds a plant up and lets people walk in it.
#pragma once

#include "scenes/solids.h"

namespace standoff::scenes {

void i_beam(Builder& b, const Frame& f, Vec3 from, Vec3 to, double height, double width);
/// Hexagonal bolts standing on a circle around the y axis.
void bolt_circle(Builder& b, const Frame& f, double radius, int bolts, double size);
/// An upright I-beam on a bolted base plate.
void column(Builder& b, const Frame& f, double height, double size);
/// A girder of two chords, posts and diagonals; `depth` is its height.
void truss(Builder& b, const Frame& f, Vec3 from, Vec3 to, double depth, int panels);
void railing(Builder& b, const Frame& f, Vec3 from, Vec3 to, double height);
/// Rungs in the plane z = 0 between rails at x = +-width/2; with hoops around the climber's back on request.
void ladder(Builder& b, const Frame& f, double width, double height, bool caged = false);
/// Steps from the origin that climb `height` over `run` along +z.
void stairs(Builder& b, const Frame& f, double width, double height, double run);
/// Crossed bars in the plane y = 0, over [0, x] by [0, z]. Becomes a plate where the bars would not be seen.
void grating(Builder& b, const Frame& f, double x, double z, double pitch);
/// A grating over [0, width] by [0, length] with edge beams and railings on both long sides.
void catwalk(Builder& b, const Frame& f, double width, double length, double rail_height);

}  // namespace standoff::scenes
