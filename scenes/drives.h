// SPDX-License-Identifier: Apache-2.0
// Machines and their drives. Each stands on y = 0 of its frame.
#pragma once

#include "scenes/solids.h"

namespace standoff::scenes {

/// A ribbed electric motor of radius r on feet; its shaft points along +x from the origin of the base.
void motor(Builder& b, const Frame& f, double r);
/// A gear box with a shaft on either side along x.
void gear_box(Builder& b, const Frame& f, double size);
/// A pump with its motor on a common base along +x; suction along -x, discharge upwards.
void pump(Builder& b, const Frame& f, double r);
/// A radial fan with its motor.
void fan(Builder& b, const Frame& f, double r);
/// A roll along x over [0, length] with journals and bearing housings; the axis is the x axis of the frame.
void roll(Builder& b, const Frame& f, double r, double length);
/// A spoked wheel around the y axis through the origin.
void wheel(Builder& b, const Frame& f, double r, double width, int spokes);
/// A belt on rollers along x over [0, length], `height` above the floor.
void conveyor(Builder& b, const Frame& f, double length, double width, double height);
/// A switch cabinet with doors, handles and louvres; front at +z.
void cabinet(Builder& b, const Frame& f, double width, double height, double depth);
/// A milling machine in its housing; front at +z.
void machine_tool(Builder& b, const Frame& f, double size);
/// A press of two columns, crown, ram and bed.
void press(Builder& b, const Frame& f, double size);
/// An industrial robot with six axes; its pose follows from the key.
void robot_arm(Builder& b, const Frame& f, double size, std::uint64_t key);
/// A coil of wire, spring or hose around the y axis.
void coil(Builder& b, const Frame& f, double radius, double wire, double height, int turns);

}  // namespace standoff::scenes
