// SPDX-License-Identifier: Apache-2.0
// Triangles where nodes of a scene place them.
#pragma once

#include "tests/grammar/file.h"
#include "tests/grammar/transform.h"

namespace standoff::grammar {

enum class Mirrored {
  as_it_is,     ///< what a mirror turns inside out stays so
  turned_back,  ///< its corners go the other way round
};

/// Adds the triangles of `part` at their place.
void add_placed(const Truth& part, const Transform& to, Mirrored mirrored, Truth& all);

}  // namespace standoff::grammar
