// SPDX-License-Identifier: Apache-2.0
// Tanks, and the piping that joins them.
#pragma once

#include "scenes/solids.h"

namespace standoff::scenes {

/// A bolted disc around a pipe of radius r whose face is at y = 0.
void flange(Builder& b, const Frame& f, double r);
/// A pipe with a flange at either end; corners are rounded.
void flanged_pipe(Builder& b, const Frame& f, const std::vector<Vec3>& corners, double r);
/// A valve on a pipe along the x axis, its hand wheel up.
void valve(Builder& b, const Frame& f, double r);
/// A short pipe with a flange that sticks out of a vessel along +y.
void nozzle(Builder& b, const Frame& f, double r, double reach);
/// An upright tank with dished ends on legs; `height` without the legs, which are a fifth of it.
void standing_tank(Builder& b, const Frame& f, double r, double height, bool with_ladder = true);
/// A lying tank along the x axis on two saddles, base at y = 0.
void lying_tank(Builder& b, const Frame& f, double r, double length);
/// A lying tube bundle along the x axis on two saddles.
void heat_exchanger(Builder& b, const Frame& f, double r, double length);
/// A silo: cylinder, cone below, legs around.
void silo(Builder& b, const Frame& f, double r, double height);
/// A funnel of rectangular section, open to nobody: a solid.
void hopper(Builder& b, const Frame& f, double width, double depth, double height);

}  // namespace standoff::scenes
