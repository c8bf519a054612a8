// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/collada_nodes.h"

#include <algorithm>
#include <string>

#include "io/mesh/unfolding.h"

namespace standoff {
namespace {

// Beyond any scene that was meant. Each level takes frames of assimp's stack, each node or mesh 1.5 kilobytes.
constexpr int kDeepestNode = 1000;
constexpr double kMostNodes = 1e5;
// A light's or camera's name is looked for among all nodes, which takes the time of as many nodes.
constexpr double kWeightOfLight = 100;

}  // namespace

void ColladaNodes::see(const XmlTag& tag) {
  const bool close = tag.kind == XmlTag::Kind::close;
  if (tag.name == "library_nodes") in_library_ = tag.kind == XmlTag::Kind::open;
  if (tag.name == "node" && !close) open(tag);
  if (tag.name == "node" && tag.kind != XmlTag::Kind::open && !open_.empty()) open_.pop_back();
  if (!close && !open_.empty() && (tag.name == "instance_light" || tag.name == "instance_camera"))
    ++nodes_[open_.back()].lights;
  const bool node = tag.name == "instance_node";
  if ((!node && tag.name != "instance_geometry" && tag.name != "instance_controller") || close || open_.empty()) return;
  const std::string_view url = plain(tag, "url");
  auto& list = node ? nodes_[open_.back()].instances : nodes_[open_.back()].shapes;
  list.push_back(url.substr(std::min<std::size_t>(url.size(), 1)));
  instances_ |= node;
}

void ColladaNodes::open(const XmlTag& tag) {
  const std::size_t node = nodes_.size();
  nodes_.emplace_back();
  check_number(static_cast<double>(nodes_.size()));
  const std::string_view id = plain(tag, "id"), name = plain(tag, "name");
  if (in_library_ && open_.empty()) library_.emplace(id, node);
  all_.emplace(id, node);
  if (name != id) all_.emplace(name, node);
  if (open_.empty())
    tops_.push_back(node);
  else
    nodes_[open_.back()].children.push_back(node);
  open_.push_back(node);
}

// Characters that are written in several ways could hide that two names are one.
std::string_view ColladaNodes::plain(const XmlTag& tag, std::string_view attribute) {
  const std::string_view value = tag.attribute(attribute);
  odd_names_ |= std::any_of(value.begin(), value.end(), [](unsigned char c) { return c < 0x20 || c == '&'; });
  return value;
}

void ColladaNodes::check() {
  if (instances_ && odd_names_) scan_.fail("names of nodes hold '&' or line ends; rename them, or flatten the scene");
  for (std::size_t node = 0; node < nodes_.size(); ++node) unfold(node, 0);
  // Assimp makes a mesh for every corner of its own, and one for each material that an instance binds.
  double corners = 0, unfolded = 0;
  for (const std::size_t top : tops_) {
    corners += nodes_[top].corners;
    unfolded += nodes_[top].unfolded;
  }
  check_number(unfolded);
  check_unfolded(file_, {corners, corners / 3}, file_.size());
}

void ColladaNodes::unfold(std::size_t index, int depth) {
  Node& node = nodes_[index];
  if (node.unfolded > 0) return;
  if (node.entered) scan_.fail("a node instances itself; repair the scene in the program that wrote it");
  if (depth > kDeepestNode) scan_.fail("its nodes are nested too deep; flatten the scene in the program that wrote it");
  node.entered = true;
  Node sum;
  sum.height = 1;
  sum.unfolded = 1 + kWeightOfLight * node.lights;
  for (const std::string_view shape : node.shapes) {
    const auto [corners, parts] = shapes_.size(shape);
    sum.corners += corners;
    sum.unfolded += parts;
  }
  for (const std::size_t child : node.children) add(sum, child, depth);
  for (const std::string_view target : node.instances) add_instance(sum, target, depth);
  if (sum.height > kDeepestNode)
    scan_.fail("its nodes are nested too deep; flatten the scene in the program that wrote it");
  check_number(sum.unfolded);
  node.unfolded = sum.unfolded;
  node.corners = sum.corners;
  node.height = sum.height;
}

void ColladaNodes::check_number(double unfolded) const {
  if (unfolded > kMostNodes)
    scan_.fail(
        "its nodes and what they place unfold to more than 100000, a light or camera counted as 100; "
        "instance fewer");
}

void ColladaNodes::add(Node& node, std::size_t part, int depth) {
  unfold(part, depth + 1);
  node.unfolded += nodes_[part].unfolded;
  node.corners += nodes_[part].corners;
  node.height = std::max(node.height, nodes_[part].height + 1);
}

// As assimp looks: by id in the library, then by id or name everywhere. Of several it takes one; any must do.
void ColladaNodes::add_instance(Node& node, std::string_view target, int depth) {
  constexpr std::ptrdiff_t kMostAlike = 1000;  // each instance looks at all that share the name
  const auto& names = library_.contains(target) ? library_ : all_;
  const auto [begin, end] = names.equal_range(target);
  if (std::distance(begin, end) > kMostAlike) scan_.fail("more than a thousand nodes share a name; rename them");
  double largest = 0, corners = 0;
  for (auto found = begin; found != end; ++found) {
    Node one;
    add(one, found->second, depth);
    largest = std::max(largest, one.unfolded);
    corners = std::max(corners, one.corners);
    node.height = std::max(node.height, one.height);
  }
  node.unfolded += largest;
  node.corners += corners;
}

}  // namespace standoff
