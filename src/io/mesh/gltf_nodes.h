// SPDX-License-Identifier: Apache-2.0
// The nodes of a glTF file: which of them stand in its scene, and where.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "files/file_view.h"
#include "io/mesh/json_view.h"
#include "io/mesh/scene.h"

namespace standoff {

/// The trees of nodes below the scene that is shown: the one that "scene" names, else the first. As the specification
/// demands, no node has two parents and a scene begins at nodes without any: so trees are walked, never cycles, and no
/// node more than once.
class GltfNodes {
 public:
  /// `root` is the whole JSON of the file, and must outlive it. Errors: input, as `FILE:node N: ...`.
  GltfNodes(const FileView& file, const JsonView& root);

  /// Calls visit(mesh, placement) for each node of the scene that has a mesh: a node before its children, children in
  /// the file's order. Takes no stack of its own, however deep they are. Errors: input, for what is no placement.
  void each_mesh(const std::function<void(std::uint64_t, const Placement&)>& visit) const;

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  struct Node {
    JsonView json;
    std::uint32_t parent = kNone, first_child = kNone, next_sibling = kNone;
  };

  std::string name(std::uint64_t node) const { return "node " + std::to_string(node); }
  std::uint32_t number(const JsonView& json) const;
  void add_children(std::uint32_t parent, const JsonView& children);
  void choose_scene(const JsonView& root);
  Placement placement(std::uint32_t node) const;

  const FileView& file_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> roots_;
};

}  // namespace standoff
