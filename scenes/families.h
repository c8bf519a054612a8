// SPDX-License-Identifier: Apache-2.0
// What the files of this folder give to the table in scenes.cpp.
#pragma once

#include <cstdint>

#include "scenes/size.h"

namespace standoff::scenes {

/// A sphere of 8 n^2 triangles.
Mesh sphere_of(int n, Vec3 center, double radius);

Mesh make_sphere(std::int64_t triangles);
Mesh make_box(std::int64_t triangles);
Mesh make_terrain(std::int64_t triangles);
Mesh make_slivers(std::int64_t triangles);
Mesh make_degenerate(std::int64_t triangles);
Mesh make_duplicate(std::int64_t triangles);
Mesh make_soup(std::int64_t triangles);
Mesh make_nested(std::int64_t triangles);
Mesh make_open(std::int64_t triangles);
Mesh make_one_triangle(std::int64_t triangles);
Mesh make_far_away(std::int64_t triangles);
Mesh make_tiny(std::int64_t triangles);

void draw_factory(Builder& b);
void draw_machine_1(Builder& b);
void draw_machine_2(Builder& b);
void draw_our_process(Builder& b);
void draw_our_process_small(Builder& b);
void draw_our_process_large(Builder& b);
void draw_plane(Builder& b);
void draw_bender(Builder& b);
void draw_catapult(Builder& b);
void draw_process(Builder& b);
void draw_labyrinth(Builder& b);
void draw_fly(Builder& b);

}  // namespace standoff::scenes
