// SPDX-License-Identifier: Apache-2.0
// Small fields as OpenVDB and NanoVDB hold them.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "tests/grammar/file.h"

namespace standoff::grammar {

/// A field of less than 128 samples a side: leaves of one node.
struct TreeField {
  struct Leaf {
    std::size_t place;  ///< in its node, z fastest
    std::array<float, 512> values;
    std::array<bool, 512> active;
  };
  Truth truth;
  float background = 0;
  std::vector<Leaf> leaves;  ///< in the order of their places
};
TreeField make_tree_field(Choices& c);

}  // namespace standoff::grammar
