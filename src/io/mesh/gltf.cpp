// SPDX-License-Identifier: Apache-2.0
// glTF 2.0 and GLB: the triangles of one scene, each mesh once for every node that holds it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "files/file_view.h"
#include "files/json_view.h"
#include "io/mesh/builder.h"
#include "io/mesh/format.h"
#include "io/mesh/gltf_data.h"
#include "io/mesh/scene.h"
#include "io/mesh/writers.h"

namespace standoff {
namespace {

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

/// Lists, strips and fans of triangles; points and lines are passed over. Materials, skins and morph targets are left
/// out. Errors everywhere: input, as `FILE:mesh N primitive N: ...`.
class GltfMeshes {
 public:
  /// Of the file's list "meshes", where there is one. The numbers must outlive it.
  GltfMeshes(const FileView& file, const std::optional<JsonView>& meshes, GltfNumbers& numbers);

  /// What placing a mesh once adds; its buffers are read and found to hold it.
  Unfolded size(std::uint64_t mesh);

  /// Adds a mesh at its place. Corners turn the other way round where the placement mirrors, as the specification
  /// demands, so that what was outside stays outside.
  void place(std::uint64_t mesh, const Placement& placement, MeshBuilder& builder);

  /// Where the vertices of a builder came from, for messages.
  std::string place_of_vertex(std::size_t vertex) const;

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  enum class Mode : std::uint8_t { list = 4, strip, fan };

  struct Primitive {
    std::uint64_t positions, indices;  // accessors
    std::uint32_t number;              // in its mesh
    Mode mode;
  };
  struct Mesh {
    std::size_t first, last;  // in primitives_
    Unfolded size;
    bool required = false;
  };
  // Vertices of a builder from here on are those of an accessor.
  struct Origin {
    std::size_t first;
    std::uint64_t accessor;
  };

  Mesh& find(std::uint64_t mesh);
  std::string name(std::uint64_t mesh, std::uint32_t primitive) const;
  void add_mesh(const JsonView& json);
  void add_primitive(const JsonView& json, std::uint32_t number);
  std::uint64_t triangles(std::uint64_t corners, Mode mode, const std::string& where) const;
  void add_triangles(const Primitive& primitive, std::uint32_t first, bool mirrored, MeshBuilder& builder) const;

  const FileView& file_;
  GltfNumbers& numbers_;
  std::vector<Mesh> meshes_;
  std::vector<Primitive> primitives_;
  std::vector<std::uint32_t> corners_;  // of the primitive at hand
  std::vector<Origin> origins_;
};

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

// Ten times what scenes need; each level takes a frame of the reader's stack.
constexpr int kDeepestScene = 200;

void check_version(const FileView& file, const JsonView& root) {
  const auto asset = root.find("asset"), version = asset ? asset->find("version") : std::nullopt,
             least = asset ? asset->find("minVersion") : std::nullopt;
  if (!version) file.fail("", "its asset has no version; check that it is a glTF file, and write it again");
  const auto shown = [](const JsonView& json) {
    return json.kind() == JsonView::Kind::string ? json.text() : std::string("1");  // version 1 wrote numbers, too
  };
  if (!shown(*version).starts_with("2.") || (least && shown(*least) != "2.0"))
    version->fail("version " + in_quotes(shown(least ? *least : *version)) +
                  " of glTF is not read; convert it to version 2.0, or to STL, PLY or OBJ");
}

// Extensions that a file needs to be understood, and that change nothing of its shape or are read.
void check_extensions(const FileView& file, const JsonView& root) {
  constexpr std::array<std::string_view, 9> kHarmless{"KHR_mesh_quantization", "KHR_materials_", "KHR_texture_",
                                                      "KHR_lights_",           "KHR_technique",  "EXT_texture_",
                                                      "EXT_materials_",        "EXT_lights_",    "MSFT_texture_"};
  const auto required = root.find("extensionsRequired");
  if (!required) return;
  required->each_element([&](const JsonView& json) {
    const std::string name = json.text();
    if (std::ranges::none_of(kHarmless, [&](std::string_view known) { return name.starts_with(known); }))
      file.fail("", "it cannot be read without the extension " + in_quotes(name) +
                        ", which is not read here; write the file again without it, meshes uncompressed");
  });
}

Mesh read_scene(const FileView& file, std::string_view json, std::optional<std::string_view> binary) {
  const JsonView root = JsonView::read(file, json, kDeepestScene);
  check_version(file, root);
  check_extensions(file, root);
  GltfBuffers buffers(file, root.find("buffers"), root.find("bufferViews"), binary);
  GltfNumbers numbers(file, root.find("accessors"), buffers);
  GltfMeshes meshes(file, root.find("meshes"), numbers);
  const GltfNodes nodes(file, root);

  Unfolded unfolded;
  nodes.each_mesh([&](std::uint64_t mesh, const Placement&) {
    const Unfolded size = meshes.size(mesh);
    unfolded.vertices += size.vertices;
    unfolded.triangles += size.triangles;
    unfolded.corners = std::max(unfolded.corners, size.corners);
  });
  check_unfolded(file, unfolded, file.size() + buffers.companion_bytes());
  check_counts(file, static_cast<std::uint64_t>(unfolded.vertices), static_cast<std::uint64_t>(unfolded.triangles));

  MeshBuilder builder(file);
  builder.vertices.reserve(static_cast<std::size_t>(unfolded.vertices));
  builder.triangles.reserve(static_cast<std::size_t>(unfolded.triangles));
  nodes.each_mesh([&](std::uint64_t mesh, const Placement& placement) { meshes.place(mesh, placement, builder); });
  return builder.finish([&](std::size_t vertex) { return meshes.place_of_vertex(vertex); });
}

std::string at_byte(std::size_t byte) { return "byte " + std::to_string(byte); }

constexpr std::size_t kHeader = 12, kChunkHeader = 8;

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

// The length in the header of a binary glTF.
std::size_t check_header(const FileView& file) {
  const std::string_view bytes = file.bytes();
  if (!bytes.starts_with("glTF")) file.fail(at_byte(0), "a binary glTF starts with glTF; check that it is one");
  if (bytes.size() < kHeader + kChunkHeader)
    file.fail(at_byte(bytes.size()), "the file ends in its header; it is cut off, get all of it");
  if (const auto version = number_at(bytes, 4); version != 2)
    file.fail(at_byte(4), "version " + std::to_string(version) + " of glTF is not read; convert it to version 2");
  const std::size_t length = number_at(bytes, 8);
  if (length > bytes.size() || length < kHeader + kChunkHeader)
    file.fail(at_byte(8), "it promises " + std::to_string(length) + " bytes and has " + std::to_string(bytes.size()) +
                              "; it is cut off or damaged, get all of it");
  return length;
}

constexpr std::uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;

// Where the next chunk begins. Chunks are padded to a multiple of four bytes, and their lengths count that. Some
// programs do not pad; some do, and do not count it. Which one it was, the type of a binary chunk tells.
std::size_t next_chunk(std::string_view bytes, std::size_t end, std::size_t length) {
  const std::size_t padded = (end + 3) / 4 * 4;
  const bool unpadded = end != padded && length - end >= kChunkHeader && number_at(bytes, end + 4) == kBinary;
  return std::min(length, unpadded ? end : padded);
}

bool is_glb(std::string_view content) { return content.starts_with("glTF"); }
bool is_gltf(std::string_view content) {
  const auto first = content.find_first_not_of(" \t\r\n");
  return first != content.npos && content[first] == '{' && content.find("\"asset\"") != content.npos;
}

Mesh read_gltf(const FileView& file) { return read_scene(file, file.bytes(), {}); }

// Chunks: the JSON first, then the binary part; others are passed over.
Mesh read_glb(const FileView& file) {
  const std::string_view bytes = file.bytes();
  const std::size_t length = check_header(file);
  std::optional<std::string_view> json, binary;
  for (std::size_t at = kHeader; length - at >= kChunkHeader;) {
    const std::size_t chunk = number_at(bytes, at), left = length - at - kChunkHeader;
    const std::uint32_t type = number_at(bytes, at + 4);
    if (chunk > left)
      file.fail(at_byte(at), "a chunk of " + std::to_string(chunk) + " bytes, where " + std::to_string(left) +
                                 " are left; the file is cut off or damaged, get all of it");
    const std::string_view content = bytes.substr(at + kChunkHeader, chunk);
    if (!json && type != kJson) file.fail(at_byte(at + 4), "the first chunk is not its JSON; write the file again");
    if (!json)
      json = content;
    else if (type == kBinary && !binary)
      binary = content;
    at = next_chunk(bytes, at + kChunkHeader + chunk, length);
  }
  return read_scene(file, *json, binary);
}

}  // namespace

constinit const MeshFormat kMeshGltf{"gltf",  "glTF", "glTF 2.0, JSON", is_gltf, in_metres<read_gltf>,
                                     nullptr, false,  Axis::y};
constinit const MeshFormat kMeshGlb{"glb", "GLB",  "glTF 2.0, binary", is_glb, in_metres<read_glb>, write_glb,
                                    false, Axis::y};

}  // namespace standoff
