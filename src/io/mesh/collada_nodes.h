// SPDX-License-Identifier: Apache-2.0
// Which nodes of a COLLADA scene instance which.
#pragma once

#include <cstddef>
#include <map>
#include <string_view>
#include <vector>

#include "files/xml_scan.h"
#include "io/mesh/collada_shapes.h"

namespace standoff {

/// Collects nodes, their instances and their shapes; at the end they must unfold to a tree that fits memory and stack.
class ColladaNodes {
 public:
  ColladaNodes(const FileView& file, const XmlScan& scan, const ColladaShapes& shapes)
      : file_(file), scan_(scan), shapes_(shapes) {}

  /// Sees every tag.
  void see(const XmlTag& tag);
  /// Throws where nodes instance themselves, or they or their shapes unfold too far. Once all tags are seen.
  void check();

 private:
  struct Node {
    std::vector<std::size_t> children;
    std::vector<std::string_view> instances, shapes;
    double lights = 0;    // and cameras that it places itself
    double unfolded = 0;  // nodes, and what these place; zero until known
    double corners = 0;   // of the shapes of all these
    int height = 0;
    bool entered = false;
  };

  void open(const XmlTag& tag);
  std::string_view plain(const XmlTag& tag, std::string_view attribute);
  void unfold(std::size_t node, int depth);
  void check_number(double unfolded) const;
  void add(Node& node, std::size_t part, int depth);
  void add_instance(Node& node, std::string_view target, int depth);

  const FileView& file_;
  const XmlScan& scan_;
  const ColladaShapes& shapes_;
  std::vector<Node> nodes_;
  std::vector<std::size_t> open_, tops_;
  bool in_library_ = false;
  bool instances_ = false;
  bool odd_names_ = false;
  std::multimap<std::string_view, std::size_t> library_, all_;
};

}  // namespace standoff
