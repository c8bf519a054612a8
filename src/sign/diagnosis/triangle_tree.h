// SPDX-License-Identifier: Apache-2.0
// The triangles of a mesh along a space-filling curve, under a tree of their boxes.
#pragma once

#include <cstdint>
#include <vector>

#include "sign/diagnosis/box_tree.h"
#include "standoff/mesh.h"

namespace standoff {

class TriangleTree {
 public:
  /// Requires a valid mesh. Runs on the threads of the calling TBB arena.
  explicit TriangleTree(MeshView mesh);

  /// The triangle of each item of the tree.
  const std::vector<std::uint32_t>& order() const { return order_; }
  const BoxTree& tree() const { return tree_; }

 private:
  std::vector<std::uint32_t> order_;
  BoxTree tree_;
};

}  // namespace standoff
