// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/gltf_nodes.h"

#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace standoff {
namespace {

template <std::size_t n>
std::array<double, n> numbers(const JsonView& json) {
  std::array<double, n> read{};
  std::size_t count = 0;
  json.each_element([&](const JsonView& value) {
    if (count < n) read[count] = value.number();
    ++count;
  });
  if (count != n)
    json.fail("expected " + std::to_string(n) + " numbers, found " + std::to_string(count) + "; repair the file");
  return read;
}

// Sixteen numbers, column by column.
Placement of_matrix(const JsonView& json) {
  constexpr double kRounding = 1e-5;
  const auto m = numbers<16>(json);
  for (std::size_t c = 0; c < 4; ++c)
    if (!(std::abs(m[4 * c + 3] - (c == 3)) <= kRounding))
      json.fail("the last row of a node's matrix is not 0 0 0 1; write the file again without perspective");
  Placement placement;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c) placement.rows[r][c] = m[4 * c + r];
  return placement;
}

// Of a quaternion x y z w, which files give rounded: it is brought to length 1.
std::array<std::array<double, 3>, 3> rotation(const JsonView& json) {
  auto q = numbers<4>(json);
  // No hypot: C libraries round it differently, and its newest version is in few of them.
  const double length = std::sqrt((q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]));
  if (!(length > 0) || !std::isfinite(length)) json.fail("a rotation is no unit quaternion; write the file again");
  for (double& c : q) c /= length;
  const auto [x, y, z, w] = q;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
}

}  // namespace

GltfNodes::GltfNodes(const FileView& file, const JsonView& root) : file_(file) {
  if (const auto nodes = root.find("nodes")) {
    const std::size_t count = nodes->size();
    if (count >= kNone) file.fail("", "too many nodes to count; split the scene");
    nodes_.reserve(count);
    nodes->each_element([&](const JsonView& json) { nodes_.push_back({json}); });
  }
  for (std::uint32_t node = 0; node < nodes_.size(); ++node)
    if (const auto children = nodes_[node].json.find("children")) add_children(node, *children);
  choose_scene(root);
}

std::uint32_t GltfNodes::number(const JsonView& json) const {
  const std::uint64_t number = json.whole();
  if (number >= nodes_.size())
    json.fail("node " + std::to_string(number) + " of " + std::to_string(nodes_.size()) +
              ", counted from 0; repair the file");
  return static_cast<std::uint32_t>(number);
}

void GltfNodes::add_children(std::uint32_t parent, const JsonView& children) {
  std::uint32_t last = kNone;
  children.each_element([&](const JsonView& json) {
    const std::uint32_t child = number(json);
    if (nodes_[child].parent != kNone || child == parent)
      file_.fail(name(child), "it is a child twice, of node " +
                                  std::to_string(child == parent ? child : nodes_[child].parent) + " and of node " +
                                  std::to_string(parent) +
                                  ", and nodes must form trees; write the file again, with a copy");
    nodes_[child].parent = parent;
    (last == kNone ? nodes_[parent].first_child : nodes_[last].next_sibling) = child;
    last = child;
  });
}

void GltfNodes::choose_scene(const JsonView& root) {
  const auto given = root.find("scene"), scenes = root.find("scenes");
  const std::uint64_t wanted = given ? given->whole() : 0;
  std::optional<JsonView> scene;
  std::uint64_t count = 0;
  if (scenes)
    scenes->each_element([&](const JsonView& json) {
      if (count++ == wanted) scene = json;
    });
  if (!scene)
    file_.fail("", count == 0 ? "it has no scene, so nothing of it is placed; write the file again with one"
                              : "it names scene " + std::to_string(wanted) + " of " + std::to_string(count) +
                                    ", counted from 0; repair the file");
  const auto nodes = scene->find("nodes");
  if (!nodes) return;
  std::vector<bool> named(nodes_.size());
  nodes->each_element([&](const JsonView& json) {
    const std::uint32_t node = number(json);
    if (nodes_[node].parent != kNone || named[node])
      file_.fail(name(node),
                 "the scene begins at it, and so it may be there twice: it is a child of another node, or "
                 "named twice; write the file again");
    named[node] = true;
    roots_.push_back(node);
  });
}

void GltfNodes::each_mesh(const std::function<void(std::uint64_t, const Placement&)>& visit) const {
  std::vector<std::pair<std::uint32_t, Placement>> open;  // with the placement of the parent
  for (const std::uint32_t root : roots_) {
    open.emplace_back(root, Placement());
    while (!open.empty()) {
      const auto [number, outer] = open.back();
      open.pop_back();
      const Node& node = nodes_[number];
      const Placement placed = outer * placement(number);
      if (const auto mesh = node.json.find("mesh")) visit(mesh->whole(), placed);
      if (node.next_sibling != kNone) open.emplace_back(node.next_sibling, outer);
      if (node.first_child != kNone) open.emplace_back(node.first_child, placed);
    }
  }
}

Placement GltfNodes::placement(std::uint32_t node) const {
  const JsonView& json = nodes_[node].json;
  if (const auto extensions = json.find("extensions"); extensions && extensions->find("EXT_mesh_gpu_instancing"))
    file_.fail(name(node),
               "instances by EXT_mesh_gpu_instancing are not read; write the file again with a node for each");
  if (const auto matrix = json.find("matrix")) return of_matrix(*matrix);
  Placement placement;
  if (const auto given = json.find("rotation")) {
    const auto turned = rotation(*given);
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) placement.rows[r][c] = turned[r][c];
  }
  if (const auto given = json.find("scale")) {
    const auto scale = numbers<3>(*given);
    for (auto& row : placement.rows)
      for (std::size_t c = 0; c < 3; ++c) row[c] *= scale[c];
  }
  if (const auto given = json.find("translation")) {
    const auto shift = numbers<3>(*given);
    for (std::size_t r = 0; r < 3; ++r) placement.rows[r][3] = shift[r];
  }
  return placement;
}

}  // namespace standoff
