// The triangles of a body in a tree of sixteen-fold branches, without pointers: node n of a level has the nodes
// 16 n to 16 n + 15 of the level below as children. Level 0 holds the triangles themselves.
#pragma once

#include <cstdint>
#include <vector>

#include "collision/body/simd_blocks.h"
#include "core/huge_page_vector.h"
#include "geometry/triangle_pair.h"
#include "standoff/mesh.h"

namespace standoff::collision {

struct Level {
  BigVector<Balls> balls;  ///< packet n: the children of node n of the level above
  BigVector<Boxes> boxes;
};

struct Tree {
  std::vector<std::uint32_t> order;  ///< triangles of the mesh, by their place in the tree
  std::vector<Level> levels;         ///< the last one has a single packet
  BigVector<Faces> faces;  ///< the triangles, in packets of the lowest level; lanes left over repeat the last one
  int top() const { return static_cast<int>(levels.size()) - 1; }
};

/// Builds the tree over triangles whose coordinates are taken relative to `middle`. Triangles that are near each other
/// come to stand together: ranges are halved, in multiples of full nodes, along the longest side of their centres' box.
/// The same on every run, by any number of threads.
Tree build_tree(MeshView mesh, Vec3 middle);

/// The balls and boxes of a tree whose order is given.
void fill_levels(Tree& tree, MeshView mesh, Vec3 middle);

}  // namespace standoff::collision
