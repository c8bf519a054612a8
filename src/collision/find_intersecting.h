// The search for one pair of triangles that touch, which several queries begin with.
#pragma once

#include <cstdint>
#include <optional>

#include "collision/pair.h"

namespace standoff::collision {

/// Two triangles by their places in the trees.
struct Touching {
  std::uint32_t of_field, of_tree;
};

/// A pair of triangles that touch or are within the margin; nothing where there is none.
std::optional<Touching> find_touching(const Pair& pair, double margin);

/// Free, hit or ambiguous, from the field alone.
Verdict certify(const Pair& pair, double margin);

}  // namespace standoff::collision
