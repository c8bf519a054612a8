// SPDX-License-Identifier: Apache-2.0
// 3DS: chunks within chunks. The editor's chunk holds meshes, whose vertices stand where the scene was saved. The
// keyframer's chunk holds a tree of nodes, which place the meshes of their name: a mesh is first brought back to its
// own axes by the inverse of its matrix, and moved so that the node's pivot is its origin. Animations stand at their
// first key. Meshes that no node names are left out, except where there are no nodes: then all stay where they are
// saved. The result has y up, where files have z up, and the master scale is divided out of it.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "files/file_view.h"
#include "io/mesh/builder.h"
#include "io/mesh/format.h"
#include "io/mesh/scene.h"

namespace standoff {
namespace {

// What is left of a chunk's content.
class ChunkBytes {
 public:
  ChunkBytes(const FileView& file, std::size_t begin, std::size_t end) : file_(file), at_(begin), end_(end) {}

  std::size_t left() const { return end_ - at_; }
  [[noreturn]] void fail(const std::string& message) const { file_.fail("byte " + std::to_string(at_), message); }
  void require(std::size_t bytes) const {
    if (bytes > left())
      fail("a chunk ends " + std::to_string(bytes - left()) +
           " bytes too early; the file is cut off or damaged, get all of it");
  }

  template <class Number>
  Number take() {
    require(sizeof(Number));
    const Number number = file_.number<Number>(at_);
    at_ += sizeof(Number);
    return number;
  }
  Vec3 take_vector() {
    const auto x = take<float>(), y = take<float>(), z = take<float>();
    return {x, y, z};
  }
  void skip(std::size_t bytes) {
    require(bytes);
    at_ += bytes;
  }
  std::string_view take_name() {
    const std::string_view text = file_.text(at_, left());
    const std::size_t length = text.find('\0');
    if (length == text.npos) fail("a name without an end; the file is cut off or damaged, get all of it");
    at_ += length + 1;
    return text.substr(0, length);
  }

  // Calls see(id, content) for each chunk up to the end.
  template <class See>
  void each_chunk(const See& see) {
    constexpr std::size_t kHeader = 6;  // what it is, and its length with this header
    while (left() >= kHeader) {
      const ChunkBytes here = *this;
      const auto id = take<std::uint16_t>();
      const std::size_t size = take<std::uint32_t>();
      if (size < kHeader)
        here.fail("a chunk of " + std::to_string(size) + " bytes; the file is damaged, write it again");
      if (size - kHeader > file_.size() - at_)
        here.fail("a chunk of " + std::to_string(size) + " bytes, where " + std::to_string(file_.size() - here.at_) +
                  " are left; the file is cut off or damaged, get all of it");
      if (size - kHeader > left())
        here.fail("chunks, which reach into each other; the file is damaged, write it again");
      see(id, ChunkBytes(file_, at_, at_ + size - kHeader));
      at_ += size - kHeader;
    }
  }

 private:
  const FileView& file_;
  std::size_t at_, end_;
};

struct StudioMesh {
  std::string_view name;
  std::vector<Vec3> vertices;
  std::vector<Triangle> faces;
  Placement matrix;  // from the mesh's own axes to where its vertices stand
};

// The value of a track's earliest key.
template <class Value>
struct FirstKey {
  std::optional<Value> value;
  std::uint32_t frame = 0;

  void see(std::uint32_t at, const Value& found) {
    if (value && at >= frame) return;
    value = found;
    frame = at;
  }
};

struct StudioNode {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  std::string_view name;
  std::size_t parent = kNone;
  std::int16_t place = -1;  // one more than the number of the node above it
  std::vector<std::size_t> children;
  Vec3 pivot;
  FirstKey<Vec3> position, scale;
  FirstKey<std::pair<Vec3, double>> rotation;  // axis, angle in radians
  FirstKey<double> roll_deg;                   // of a camera

  Placement placement() const;
};

// Scaled, then turned, then moved. Angles run clockwise.
Placement StudioNode::placement() const {
  Placement made;
  if (rotation.value)
    made = rotation_about((1 / length(rotation.value->first)) * rotation.value->first, -rotation.value->second);
  else if (roll_deg.value)
    made = rotation_about({0, 0, 1}, -*roll_deg.value * (std::numbers::pi / 180));
  const Vec3 by = scale.value.value_or(Vec3{1, 1, 1}), to = position.value.value_or(Vec3{});
  for (auto& row : made.rows) row = {row[0] * by.x, row[1] * by.y, row[2] * by.z, 0};
  made.rows[0][3] = to.x, made.rows[1][3] = to.y, made.rows[2][3] = to.z;
  return made;
}

class StudioReader {
 public:
  explicit StudioReader(const FileView& file) : file_(file), nodes_(1), builder_(file) { nodes_[0].name = "UNNAMED"; }

  Mesh read(MeshReadReport& report) {
    constexpr std::uint16_t kMain = 0x4d4d;
    ChunkBytes(file_, 0, file_.size()).each_chunk([this](std::uint16_t id, ChunkBytes content) {
      if (id == kMain) read_main(content);
    });
    const double scale = master_scale_ == 0 ? 1 : 1 / double(master_scale_);
    Placement root{{{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}}}};
    if (nodes_.size() > 1) root = root * nodes_[0].placement();
    root = root * scaling({scale, scale, scale});
    report_axes(root, report);
    place(root);
    return builder_.finish([](std::size_t v) { return "vertex " + std::to_string(v); });
  }

 private:
  // Meshes of one name.
  struct Namesakes {
    std::vector<std::size_t> meshes;
    Unfolded size;
  };

  void read_main(ChunkBytes content) {
    constexpr std::uint16_t kEditor = 0x3d3d, kKeyframer = 0xb000;
    content.each_chunk([this](std::uint16_t id, ChunkBytes part) {
      if (id == kEditor) read_editor(part);
      if (id == kKeyframer) part.each_chunk([this](std::uint16_t kind, ChunkBytes node) { read_node(kind, node); });
    });
  }

  void read_editor(ChunkBytes content) {
    constexpr std::uint16_t kMasterScale = 0x0100, kObject = 0x4000, kMesh = 0x4100;
    content.each_chunk([this](std::uint16_t id, ChunkBytes part) {
      if (id == kMasterScale) master_scale_ = part.take<float>();
      if (id != kObject) return;
      const std::string_view name = part.take_name();
      part.each_chunk([&](std::uint16_t kind, ChunkBytes mesh) {
        if (kind == kMesh) read_mesh(name, mesh);
      });
    });
  }

  void read_mesh(std::string_view name, ChunkBytes content) {
    constexpr std::uint16_t kVertices = 0x4110, kFaces = 0x4120, kMatrix = 0x4160;
    file_.check();
    StudioMesh mesh{name, {}, {}, {}};
    content.each_chunk([&](std::uint16_t id, ChunkBytes part) {
      if (id == kVertices) read_vertices(part, mesh);
      if (id == kFaces) read_faces(part, mesh);
      if (id == kMatrix)
        for (std::size_t column = 0; column < 4; ++column)
          for (auto& row : mesh.matrix.rows) row[column] = part.take<float>();
    });
    check_corners(mesh);
    if (mesh.faces.empty()) return;
    keep_used(mesh.vertices, mesh.faces);
    Namesakes& alike = by_name_[name];
    alike.meshes.push_back(meshes_.size());
    alike.size.vertices += static_cast<double>(mesh.vertices.size());
    alike.size.triangles += static_cast<double>(mesh.faces.size());
    meshes_.push_back(std::move(mesh));
  }

  static void read_vertices(ChunkBytes& part, StudioMesh& mesh) {
    const std::size_t count = part.take<std::uint16_t>();
    part.require(3 * sizeof(float) * count);
    mesh.vertices.reserve(mesh.vertices.size() + count);
    for (std::size_t n = 0; n < count; ++n) mesh.vertices.push_back(part.take_vector());
  }

  static void read_faces(ChunkBytes& part, StudioMesh& mesh) {
    const std::size_t count = part.take<std::uint16_t>();
    part.require(4 * sizeof(std::uint16_t) * count);
    mesh.faces.reserve(mesh.faces.size() + count);
    for (std::size_t n = 0; n < count; ++n) {
      Triangle& face = mesh.faces.emplace_back();
      for (auto& corner : face) corner = part.take<std::uint16_t>();
      part.skip(sizeof(std::uint16_t));  // which of its edges are seen
    }
  }

  void check_corners(const StudioMesh& mesh) const {
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
      for (const auto corner : mesh.faces[f])
        if (corner >= mesh.vertices.size())
          file_.fail("mesh " + in_quotes(mesh.name) + " face " + std::to_string(f),
                     "vertex index " + std::to_string(corner) + " is out of range, there are " +
                         std::to_string(mesh.vertices.size()) + " vertices; repair the mesh");
  }

  static constexpr std::uint16_t kObjectNode = 0xb002, kCameraNode = 0xb003, kCameraTarget = 0xb004,
                                 kLightTarget = 0xb006, kLastNode = 0xb007;

  void read_node(std::uint16_t kind, ChunkBytes content) {
    constexpr std::uint16_t kName = 0xb010, kDummyName = 0xb011, kPivot = 0xb013, kFirstTrack = 0xb020,
                            kLastTrack = 0xb029;
    if (kind < kObjectNode || kind > kLastNode) return;
    content.each_chunk([&](std::uint16_t id, ChunkBytes part) {
      if (id == kName) read_name(kind, part);
      if (id == kDummyName) rename_dummy(part.take_name());
      if (id == kPivot && kind == kObjectNode) nodes_[current_].pivot = part.take_vector();
      if (id >= kFirstTrack && id <= kLastTrack) read_track(kind, id, part);
    });
  }

  // Of several objects of one name each is a node; a camera or light that has the name of a node is that one.
  void read_name(std::uint16_t kind, ChunkBytes part) {
    const std::string_view name = part.take_name();
    if (kind != kObjectNode)
      if (const auto found = first_of_name_.find(name); found != first_of_name_.end()) {
        current_ = found->second;
        return;
      }
    part.skip(2 * sizeof(std::uint16_t));
    add_node(name, static_cast<std::uint16_t>(part.take<std::uint16_t>() + 1));
  }

  // A file lists its nodes from the top down, and names of each only the number of the one above it: so it is a sibling
  // of the node before, a child of it, or a sibling of one further up.
  void add_node(std::string_view name, std::uint16_t place) {
    constexpr std::size_t kMostNodes = 100'000;
    const std::size_t added = nodes_.size();
    if (added > kMostNodes)
      file_.fail("", "more than " + std::to_string(kMostNodes) +
                         " nodes in its keyframes; write the file again without animation");
    StudioNode node;
    node.name = name;
    node.place = static_cast<std::int16_t>(place);
    if (nodes_[current_].place == place) {
      node.parent = nodes_[current_].parent;
      ++last_place_;
    } else if (place >= last_place_) {
      node.parent = current_;
      last_place_ = node.place;
    } else {
      std::size_t sibling = current_;
      while (sibling != 0 && nodes_[sibling].place != node.place) sibling = nodes_[sibling].parent;
      node.parent = sibling == 0 ? 0 : nodes_[sibling].parent;
      ++last_place_;
    }
    nodes_[node.parent].children.push_back(added);
    nodes_.push_back(std::move(node));
    first_of_name_.emplace(name, added);
    current_ = added;
  }

  void rename_dummy(std::string_view name) {
    constexpr std::string_view kDummy = "$$$DUMMY";
    if (nodes_[current_].name != kDummy) return;
    if (const auto found = first_of_name_.find(kDummy); found != first_of_name_.end() && found->second == current_)
      first_of_name_.erase(found);
    nodes_[current_].name = name;
    first_of_name_.emplace(name, current_);
  }

  void read_track(std::uint16_t kind, std::uint16_t id, ChunkBytes part) {
    constexpr std::uint16_t kPosition = 0xb020, kRotation = 0xb021, kScale = 0xb022, kRoll = 0xb024;
    constexpr std::size_t kBefore = 10, kLeastKey = 6;  // a key: the frame's number, its flags, values
    if (part.left() < kBefore + sizeof(std::uint32_t) && id != kPosition && id != kRotation && id != kScale) return;
    part.skip(kBefore);
    const ChunkBytes here = part;
    const auto keys = part.take<std::uint32_t>();
    if (keys > part.left() / kLeastKey)
      here.fail("a track of " + std::to_string(keys) + " keys, where " + std::to_string(part.left()) +
                " bytes are left; the file is cut off or damaged, get all of it");
    const bool target = kind == kCameraTarget || kind == kLightTarget;
    if (!(id == kPosition && !target) && id != kRotation && id != kScale && !(id == kRoll && kind == kCameraNode))
      return;
    StudioNode& node = nodes_[current_];
    for (std::uint32_t n = 0; n < keys; ++n) {
      const std::uint32_t frame = take_frame(part);
      if (id == kPosition) node.position.see(frame, part.take_vector());
      if (id == kRotation) node.rotation.see(frame, take_rotation(part));
      if (id == kScale) node.scale.see(frame, take_scale(part));
      if (id == kRoll) node.roll_deg.see(frame, part.take<float>());
    }
  }

  static std::uint32_t take_frame(ChunkBytes& part) {
    const auto frame = part.take<std::uint32_t>();
    const auto flags = part.take<std::uint16_t>();
    for (unsigned bit = 0; bit < 5; ++bit)  // tension, continuity, bias and two more may stand before the value
      if (flags >> bit & 1) part.skip(sizeof(float));
    return frame;
  }
  static std::pair<Vec3, double> take_rotation(ChunkBytes& part) {
    const double angle_rad = part.take<float>();
    const Vec3 axis = part.take_vector();
    return {axis == Vec3{} ? Vec3{0, 1, 0} : axis, angle_rad};
  }
  // Some programs write zero where they mean one.
  static Vec3 take_scale(ChunkBytes& part) {
    const Vec3 by = part.take_vector();
    return {by.x == 0 ? 1 : by.x, by.y == 0 ? 1 : by.y, by.z == 0 ? 1 : by.z};
  }

  void place(const Placement& root) {
    std::vector<std::pair<const Namesakes*, Placement>> placed;
    if (nodes_.size() == 1)
      for (const auto& [name, meshes] : by_name_) placed.emplace_back(&meshes, root);
    else
      unfold(root, placed);
    Unfolded unfolded;
    for (const auto& [meshes, placement] : placed) {
      unfolded.vertices += meshes->size.vertices;
      unfolded.triangles += meshes->size.triangles;
    }
    check_unfolded(file_, unfolded, file_.size());
    check_counts(file_, static_cast<std::uint64_t>(unfolded.vertices), static_cast<std::uint64_t>(unfolded.triangles));
    builder_.vertices.reserve(static_cast<std::size_t>(unfolded.vertices));
    builder_.triangles.reserve(static_cast<std::size_t>(unfolded.triangles));
    if (nodes_.size() == 1)
      for (const StudioMesh& mesh : meshes_) add(mesh, root);
    else
      for (const auto& [meshes, placement] : placed)
        for (const std::size_t mesh : meshes->meshes) add(meshes_[mesh], placement);
  }

  // Finds the meshes of each node, from the top down.
  void unfold(const Placement& root, std::vector<std::pair<const Namesakes*, Placement>>& placed) {
    std::map<std::string_view, Placement> own_axes;  // of the meshes of a name
    std::vector<std::pair<std::size_t, Placement>> open{{0, root}};
    while (!open.empty()) {
      const auto [number, placement] = open.back();
      open.pop_back();
      const StudioNode& node = nodes_[number];
      if (const auto meshes = by_name_.find(node.name); meshes != by_name_.end()) {
        auto own = own_axes.find(node.name);
        if (own == own_axes.end())
          own = own_axes.emplace(node.name, to_own_axes(meshes_[meshes->second.meshes[0]], node.pivot)).first;
        placed.emplace_back(&meshes->second, placement * own->second);
      }
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
        open.emplace_back(*child, placement * nodes_[*child].placement());
    }
  }

  // A mesh that its matrix mirrors is mirrored back.
  Placement to_own_axes(const StudioMesh& mesh, Vec3 pivot) const {
    const auto inverse = mesh.matrix.inverse();
    if (!inverse)
      file_.fail("mesh " + in_quotes(mesh.name), "its matrix has no inverse; repair the mesh in a modelling program");
    const double x = mesh.matrix.mirrors() ? -1 : 1;
    return Placement{{{{x, 0, 0, -pivot.x}, {0, 1, 0, -pivot.y}, {0, 0, 1, -pivot.z}}}} * *inverse;
  }

  void add(const StudioMesh& mesh, const Placement& placement) {
    file_.check();
    const auto first = static_cast<std::uint32_t>(builder_.vertices.size());
    for (const Vec3& v : mesh.vertices) builder_.vertices.push_back(placement(v));
    for (const auto& [a, b, c] : mesh.faces) builder_.triangles.push_back({first + a, first + b, first + c});
  }

  const FileView& file_;
  float master_scale_ = 1;
  std::vector<StudioMesh> meshes_;
  std::map<std::string_view, Namesakes> by_name_;
  std::vector<StudioNode> nodes_;  // the first one holds all others
  std::map<std::string_view, std::size_t> first_of_name_{{"UNNAMED", 0}};
  std::size_t current_ = 0;
  std::int16_t last_place_ = -1;
  MeshBuilder builder_;
};

// The main chunk: 0x4d4d, and a length that is the file's.
bool is_3ds(std::string_view content) {
  std::uint32_t length = 0;
  if (content.size() < 6 || !content.starts_with("MM")) return false;
  std::memcpy(&length, content.data() + 2, sizeof length);
  return length == content.size();
}

Mesh read_3ds(const FileView& file, MeshReadReport& report) { return StudioReader(file).read(report); }

}  // namespace

constinit const MeshFormat kMesh3ds{"3ds", "3DS", "3D Studio", is_3ds, read_3ds, nullptr, false, Axis::y};

}  // namespace standoff
