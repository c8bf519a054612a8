// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/gltf_meshes.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace standoff {

GltfMeshes::GltfMeshes(const FileView& file, const std::optional<JsonView>& meshes, GltfNumbers& numbers)
    : file_(file), numbers_(numbers) {
  if (meshes) meshes->each_element([&](const JsonView& json) { add_mesh(json); });
}

GltfMeshes::Mesh& GltfMeshes::find(std::uint64_t mesh) {
  if (mesh >= meshes_.size())
    file_.fail("", "a node names mesh " + std::to_string(mesh) + " of " + std::to_string(meshes_.size()) +
                       ", counted from 0; repair the file");
  return meshes_[mesh];
}

std::string GltfMeshes::name(std::uint64_t mesh, std::uint32_t primitive) const {
  return "mesh " + std::to_string(mesh) + " primitive " + std::to_string(primitive);
}

void GltfMeshes::add_mesh(const JsonView& json) {
  const std::size_t begin = primitives_.size();
  if (const auto primitives = json.find("primitives")) {
    std::uint32_t number = 0;
    primitives->each_element([&](const JsonView& primitive) { add_primitive(primitive, number++); });
  }
  // Primitives that share their positions share their vertices.
  Mesh mesh{begin, primitives_.size(), {}};
  std::set<std::uint64_t> positions;
  for (std::size_t p = mesh.first; p < mesh.last; ++p) {
    const Primitive& primitive = primitives_[p];
    const std::uint64_t vertices = numbers_.count(primitive.positions);
    if (positions.insert(primitive.positions).second) mesh.size.vertices += static_cast<double>(vertices);
    const std::uint64_t corners = primitive.indices == kNone ? vertices : numbers_.count(primitive.indices);
    mesh.size.corners = std::max(mesh.size.corners, static_cast<double>(corners));
    mesh.size.triangles +=
        static_cast<double>(triangles(corners, primitive.mode, name(meshes_.size(), primitive.number)));
  }
  meshes_.push_back(mesh);
}

void GltfMeshes::add_primitive(const JsonView& json, std::uint32_t number) {
  constexpr std::uint64_t kList = 4, kFan = 6;
  const auto attributes = json.find("attributes"), given = json.find("mode"), indices = json.find("indices");
  const auto position = attributes ? attributes->find("POSITION") : std::nullopt;
  const std::uint64_t mode = given ? given->whole() : kList;
  const std::string where = name(meshes_.size(), number);
  if (mode > kFan) file_.fail(where, "mode " + std::to_string(mode) + " is none of glTF's; repair the file");
  if (mode < kList) return;
  if (!position) file_.fail(where, "no POSITION in its attributes; it has no shape, write the file again without it");
  const Primitive primitive{position->whole(), indices ? indices->whole() : kNone, number, static_cast<Mode>(mode)};
  const std::uint64_t corners = numbers_.count(primitive.indices == kNone ? primitive.positions : primitive.indices);
  // One that adds nothing is not kept: no file can have many placed for nothing.
  if (triangles(corners, primitive.mode, where) > 0) primitives_.push_back(primitive);
}

std::uint64_t GltfMeshes::triangles(std::uint64_t corners, Mode mode, const std::string& where) const {
  if (mode == Mode::list) {
    if (corners % 3 != 0)
      file_.fail(where, std::to_string(corners) + " corners are not those of whole triangles; repair the mesh");
    return corners / 3;
  }
  if (corners < 3)
    file_.fail(where, std::to_string(corners) + " corners are too few for its mode, " +
                          std::to_string(static_cast<int>(mode)) + "; repair the mesh");
  return corners - 2;
}

Unfolded GltfMeshes::size(std::uint64_t number) {
  Mesh& mesh = find(number);
  for (std::size_t p = mesh.first; p < mesh.last && !mesh.required; ++p) {
    numbers_.require(primitives_[p].positions);
    if (primitives_[p].indices != kNone) numbers_.require(primitives_[p].indices);
  }
  mesh.required = true;
  return mesh.size;
}

void GltfMeshes::place(std::uint64_t mesh, const Placement& placement, MeshBuilder& builder) {
  const Mesh& placed = find(mesh);
  const bool mirrored = placement.mirrors();
  std::map<std::uint64_t, std::uint32_t> first;  // vertex of an accessor's positions
  for (std::size_t p = placed.first; p < placed.last; ++p) {
    file_.check();
    const Primitive& primitive = primitives_[p];
    const auto [found, is_new] =
        first.emplace(primitive.positions, static_cast<std::uint32_t>(builder.vertices.size()));
    if (is_new) {
      origins_.push_back({builder.vertices.size(), primitive.positions});
      numbers_.read_positions(primitive.positions, builder.vertices);
      for (std::size_t v = found->second; v < builder.vertices.size(); ++v)
        builder.vertices[v] = placement(builder.vertices[v]);
    }
    const auto vertices = static_cast<std::uint32_t>(numbers_.count(primitive.positions));
    if (primitive.indices == kNone) {
      corners_.resize(vertices);
      std::iota(corners_.begin(), corners_.end(), 0u);
    } else {
      numbers_.read_indices(primitive.indices, corners_);
    }
    const auto wrong = std::ranges::find_if(corners_, [&](std::uint32_t corner) { return corner >= vertices; });
    if (wrong != corners_.end())
      file_.fail(name(mesh, primitive.number),
                 "corner " + std::to_string(wrong - corners_.begin()) + ": vertex index " + std::to_string(*wrong) +
                     " is out of range, there are " + std::to_string(vertices) + " vertices; repair the mesh");
    add_triangles(primitive, found->second, mirrored, builder);
  }
}

// In the order of the specification: every second triangle of a strip is turned, so that all look the same way.
void GltfMeshes::add_triangles(const Primitive& primitive, std::uint32_t first, bool mirrored,
                               MeshBuilder& builder) const {
  const std::size_t step = primitive.mode == Mode::list ? 3 : 1;
  for (std::size_t i = 0; i + 2 < corners_.size(); i += step) {
    std::array<std::size_t, 3> at{i, i + 1, i + 2};
    if (primitive.mode == Mode::strip && i % 2 == 1) std::swap(at[1], at[2]);
    if (primitive.mode == Mode::fan) at = {i + 1, i + 2, 0};
    if (mirrored) std::swap(at[1], at[2]);
    builder.triangles.push_back({first + corners_[at[0]], first + corners_[at[1]], first + corners_[at[2]]});
  }
}

std::string GltfMeshes::place_of_vertex(std::size_t vertex) const {
  const auto after = std::ranges::upper_bound(origins_, vertex, {}, &Origin::first);
  if (after == origins_.begin()) return "vertex " + std::to_string(vertex);
  const Origin& origin = *std::prev(after);
  return "accessor " + std::to_string(origin.accessor) + " vertex " + std::to_string(vertex - origin.first);
}

}  // namespace standoff
