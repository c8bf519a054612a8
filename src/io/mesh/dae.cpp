// SPDX-License-Identifier: Apache-2.0
// COLLADA: nodes of a scene place geometries. The result has y up and is in metres, as the file's <up_axis> and <unit>
// ask for. Skins and morphs are read as the geometry that they move; animations, lights, cameras and materials are not
// looked at. What an instance names and the file does not hold is left out.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "files/file_view.h"
#include "io/mesh/builder.h"
#include "io/mesh/dae_geometry.h"
#include "io/mesh/format.h"
#include "io/mesh/scene.h"

namespace standoff {
namespace {

constexpr int kDeepestElement = 500;
constexpr int kDeepestNode = 1000;  // with the nodes that it instances; each takes frames of the stack
constexpr std::size_t kMostNodes = 500'000;

struct ColladaNode {
  std::string id, name;
  Placement placement;
  std::vector<std::size_t> children;
  std::vector<std::string> shapes, instances;  // ids of geometries or controllers, and of nodes
};

// Takes `count` numbers that are all the element holds.
template <std::size_t count>
std::array<double, count> numbers_in(const XmlScan& scan, const XmlTag& tag) {
  std::array<double, count> numbers{};
  std::string_view rest = tag.kind == XmlTag::Kind::whole ? std::string_view() : tag.text;
  for (double& number : numbers) {
    const std::string_view word = take_xml_word(rest);
    const auto found = double_in(word);
    if (!found || !std::isfinite(*found))
      scan.fail("element " + std::string(tag.name) + " must hold " + std::to_string(count) + " finite numbers, found " +
                in_quotes(word) + "; repair the file");
    number = *found;
  }
  if (const std::string_view more = take_xml_word(rest); !more.empty())
    scan.fail("element " + std::string(tag.name) + " must hold " + std::to_string(count) + " finite numbers, and " +
              in_quotes(more) + " follows; repair the file");
  return numbers;
}

Placement columns(Vec3 x, Vec3 y, Vec3 z, Vec3 shift) {
  return {{{{x.x, y.x, z.x, shift.x}, {x.y, y.y, z.y, shift.y}, {x.z, y.z, z.z, shift.z}}}};
}

Vec3 unit(const XmlScan& scan, const XmlTag& tag, Vec3 v) {
  const double size = length(v);
  if (!(size > 0)) scan.fail("element " + std::string(tag.name) + " gives no direction; repair the file");
  return (1 / size) * v;
}

Placement matrix_in(const XmlScan& scan, const XmlTag& tag) {
  constexpr double kRounding = 1e-5;
  const auto m = numbers_in<16>(scan, tag);
  for (std::size_t c = 0; c < 4; ++c)
    if (!(std::abs(m[12 + c] - (c == 3)) <= kRounding))
      scan.fail("the last row of a node's matrix is not 0 0 0 1; write the file again without perspective");
  Placement placement;
  for (std::size_t r = 0; r < 3; ++r) std::copy_n(m.begin() + 4 * r, 4, placement.rows[r].begin());
  return placement;
}

// An axis and an angle in degrees.
Placement rotation_in(const XmlScan& scan, const XmlTag& tag) {
  const auto [x, y, z, angle_deg] = numbers_in<4>(scan, tag);
  if (angle_deg == 0) return {};
  return rotation_about(unit(scan, tag, {x, y, z}), angle_deg * (std::numbers::pi / 180));
}

// Where the eye is, what it looks at, and what is up: the node's z axis points away from what is seen.
Placement lookat_in(const XmlScan& scan, const XmlTag& tag) {
  const auto n = numbers_in<9>(scan, tag);
  const Vec3 eye{n[0], n[1], n[2]}, seen{n[3], n[4], n[5]}, up{n[6], n[7], n[8]};
  const Vec3 back = unit(scan, tag, eye - seen), right = unit(scan, tag, cross(up, back));
  return columns(right, cross(back, right), back, eye);
}

// As RenderMan defines it: points move along `to`, so that `from` turns towards it by the angle.
Placement skew_in(const XmlScan& scan, const XmlTag& tag) {
  const auto n = numbers_in<7>(scan, tag);
  const double angle_rad = n[0] * (std::numbers::pi / 180);
  const Vec3 from = unit(scan, tag, {n[1], n[2], n[3]}), to = unit(scan, tag, {n[4], n[5], n[6]});
  const double along = dot(from, to);
  const Vec3 across = unit(scan, tag, from - along * to);
  const double width = dot(from, across);
  const double x = width * std::cos(angle_rad) - along * std::sin(angle_rad),
               y = width * std::sin(angle_rad) + along * std::cos(angle_rad);
  if (!(x > 0)) scan.fail("the angle of a skew is too large; repair the file");
  const Vec3 shift = (y / x - along / width) * to;
  return columns(Vec3{1, 0, 0} + across.x * shift, Vec3{0, 1, 0} + across.y * shift, Vec3{0, 0, 1} + across.z * shift,
                 {});
}

class ColladaReader {
 public:
  explicit ColladaReader(const FileView& file)
      : file_(file),
        scan_(file),
        elements_(scan_, kDeepestElement, "flatten the scene"),
        geometries_(file, scan_, elements_),
        builder_(file) {}

  Mesh read(MeshReadReport& report) {
    XmlTag root{};
    if (!scan_.next(root) || !root.opens() || root.name != "COLLADA")
      scan_.fail("the outermost element is not COLLADA; check the program that wrote the file");
    elements_.each_child(root, [this](const XmlTag& tag) { read_part(tag); });
    if (scan_.next(root)) scan_.fail("an element after the end of COLLADA; repair the file");
    find_scene();
    measured_.resize(nodes_.size());
    const Size size = measure(scene_, 0);
    check_unfolded(file_, {size.vertices, size.triangles}, file_.size());
    check_counts(file_, static_cast<std::uint64_t>(size.vertices), static_cast<std::uint64_t>(size.triangles));
    const Placement placement = axes_ * scaling({metres_per_unit_, metres_per_unit_, metres_per_unit_});
    report_axes(placement, report);
    report.metres_per_unit = 1;  // which the unit is turned into
    builder_.vertices.reserve(static_cast<std::size_t>(size.vertices));
    builder_.triangles.reserve(static_cast<std::size_t>(size.triangles));
    place(scene_, placement);
    return builder_.finish([](std::size_t v) { return "vertex " + std::to_string(v); });
  }

 private:
  // What a node and all below it unfold to.
  struct Size {
    double nodes = 0, vertices = 0, triangles = 0;
    int height = 0;
  };

  void read_part(const XmlTag& tag) {
    const auto each = [this, &tag](std::string_view name, const auto& read) {
      elements_.each_child(tag, [&](const XmlTag& child) { child.name == name ? read(child) : elements_.skip(child); });
    };
    if (tag.name == "asset")
      elements_.each_child(tag, [this](const XmlTag& child) { read_asset(child); });
    else if (tag.name == "library_geometries")
      each("geometry", [this](const XmlTag& child) { geometries_.read(child); });
    else if (tag.name == "library_controllers")
      each("controller", [this](const XmlTag& child) { read_controller(child); });
    else if (tag.name == "library_nodes")
      each("node", [this](const XmlTag& child) { add_to_library(read_node(child)); });
    else if (tag.name == "library_visual_scenes")
      each("visual_scene", [this](const XmlTag& child) { add_to_library(read_node(child)); });
    else if (tag.name == "scene")
      each("instance_visual_scene", [this](const XmlTag& child) { read_shown(child); });
    else
      elements_.skip(tag);
  }

  void read_asset(const XmlTag& tag) {
    if (tag.name == "unit") {
      const auto meter = tag.find("meter");
      const auto value = meter ? double_in(*meter) : 1;
      if (!value || !(*value > 0) || !std::isfinite(*value))
        scan_.fail("the unit's meter must be a positive number, found " + in_quotes(*meter) + "; repair the file");
      metres_per_unit_ = *value;
    }
    if (tag.name == "up_axis") {
      std::string_view text = tag.kind == XmlTag::Kind::whole ? std::string_view() : tag.text;
      const std::string_view up = take_xml_word(text);
      axes_ = {};
      if (up == "X_UP") axes_ = {{{{0, -1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}}}};
      if (up == "Z_UP") axes_ = {{{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}}}};
    }
    elements_.skip(tag);
  }

  void read_controller(const XmlTag& tag) {
    std::string& source = sources_[plain_xml(tag.attribute("id"))];
    elements_.each_child(tag, [&](const XmlTag& child) {
      if (child.name == "skin" || child.name == "morph") source = id_in(child.attribute("source")).value_or("");
      elements_.skip(child);
    });
  }

  void add_to_library(std::size_t node) { library_.insert_or_assign(nodes_[node].id, node); }

  std::size_t read_node(const XmlTag& tag) {
    const std::size_t number = nodes_.size();
    check_number(static_cast<double>(number) + 1);
    ColladaNode node;
    node.id = plain_xml(tag.attribute("id"));
    node.name = plain_xml(tag.attribute("name"));
    nodes_.emplace_back();  // its number, before those of the nodes in it
    elements_.each_child(tag, [&](const XmlTag& child) {
      if (child.name == "node") {
        node.children.push_back(read_node(child));
        return;
      }
      const auto url = id_in(child.attribute("url"));
      if (child.name == "instance_node" && url) node.instances.push_back(*url);
      if (child.name == "instance_geometry" || child.name == "instance_controller") {
        if (!url)
          scan_.fail("what an " + std::string(child.name) + " names, " + in_quotes(child.attribute("url")) +
                     ", is not in this file; write it into the file");
        node.shapes.push_back(*url);
      }
      read_transform(child, node.placement);
      elements_.skip(child);
    });
    nodes_[number] = std::move(node);
    return number;
  }

  void read_transform(const XmlTag& tag, Placement& placement) const {
    const auto vector = [&] {
      const auto [x, y, z] = numbers_in<3>(scan_, tag);
      return Vec3{x, y, z};
    };
    if (tag.name == "matrix") placement = placement * matrix_in(scan_, tag);
    if (tag.name == "translate") placement = placement * columns({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, vector());
    if (tag.name == "rotate") placement = placement * rotation_in(scan_, tag);
    if (tag.name == "scale") placement = placement * scaling(vector());
    if (tag.name == "lookat") placement = placement * lookat_in(scan_, tag);
    if (tag.name == "skew") placement = placement * skew_in(scan_, tag);
  }

  void read_shown(const XmlTag& tag) {
    if (shown_) scan_.fail("a second instance_visual_scene; write the file again with one scene");
    shown_ = id_in(tag.attribute("url")).value_or("");
    elements_.skip(tag);
  }

  // Instances name nodes of the library by their id, else nodes of the scene by id or name.
  void find_scene() {
    if (!shown_) file_.fail("", "it has no element instance_visual_scene, so nothing of it is shown; write it again");
    const auto found = library_.find(*shown_);
    if (found == library_.end())
      file_.fail("", "the scene that it shows, " + in_quotes(*shown_) + ", is not there; repair the file");
    scene_ = found->second;
    std::vector<std::size_t> open{scene_};
    while (!open.empty()) {
      const std::size_t number = open.back();
      open.pop_back();
      const ColladaNode& node = nodes_[number];
      in_scene_.emplace(node.name, number);
      in_scene_.emplace(node.id, number);
      open.insert(open.end(), node.children.rbegin(), node.children.rend());
    }
  }

  const std::size_t* find_node(const std::string& id) const {
    if (const auto found = library_.find(id); found != library_.end()) return &found->second;
    const auto found = in_scene_.find(id);
    return found == in_scene_.end() ? nullptr : &found->second;
  }

  // Controllers may move each other.
  const ColladaGeometry* find_shape(std::string_view name) const {
    constexpr int kMostControllers = 10;
    std::string id(name);
    for (int n = 0; n < kMostControllers; ++n) {
      if (const ColladaGeometry* geometry = geometries_.find(id)) return geometry;
      const auto source = sources_.find(id);
      if (source == sources_.end()) return nullptr;
      id = source->second;
    }
    return nullptr;
  }

  const Size& measure(std::size_t number, int depth) {
    constexpr int kEntered = -1;
    if (measured_[number].height == kEntered)
      file_.fail("", "a node instances itself; repair the scene in the program that wrote it");
    if (measured_[number].height > 0) return measured_[number];
    if (depth > kDeepestNode) fail_depth();
    measured_[number].height = kEntered;
    const ColladaNode& node = nodes_[number];
    Size sum{1, 0, 0, 1};
    for (const std::string& name : node.shapes)
      if (const ColladaGeometry* shape = find_shape(name)) {
        sum.nodes += static_cast<double>(shape->parts.size());
        sum.vertices += static_cast<double>(shape->vertices);
        sum.triangles += static_cast<double>(shape->triangles);
      }
    const auto add = [&](std::size_t part) {
      const Size& more = measure(part, depth + 1);
      sum.nodes += more.nodes;
      sum.vertices += more.vertices;
      sum.triangles += more.triangles;
      sum.height = std::max(sum.height, more.height + 1);
    };
    for (const std::size_t child : node.children) add(child);
    for (const std::string& target : node.instances)
      if (const std::size_t* instance = find_node(target)) add(*instance);
    if (sum.height > kDeepestNode) fail_depth();
    check_number(sum.nodes);
    return measured_[number] = sum;
  }

  [[noreturn]] void fail_depth() const {
    file_.fail("", "its nodes are nested too deep; flatten the scene in the program that wrote it");
  }
  void check_number(double nodes) const {
    if (nodes > kMostNodes)
      file_.fail(
          "", "its nodes and what they place unfold to more than " + std::to_string(kMostNodes) + "; instance fewer");
  }

  void place(std::size_t number, const Placement& outer) {
    const ColladaNode& node = nodes_[number];
    const Placement placement = outer * node.placement;
    for (const std::string& name : node.shapes)
      if (const ColladaGeometry* shape = find_shape(name))
        for (const ColladaPart& part : shape->parts) add(part, placement);
    for (const std::size_t child : node.children) place(child, placement);
    for (const std::string& target : node.instances)
      if (const std::size_t* instance = find_node(target)) place(*instance, placement);
  }

  void add(const ColladaPart& part, const Placement& placement) {
    file_.check();
    const auto first = static_cast<std::uint32_t>(builder_.vertices.size());
    for (const Vec3& v : part.vertices) builder_.vertices.push_back(placement(v));
    const std::size_t polygons = part.sizes.empty() ? part.corners.size() / 3 : part.sizes.size();
    std::vector<std::uint32_t> corners;
    auto corner = part.corners.begin();
    for (std::size_t polygon = 0; polygon < polygons; ++polygon) {
      const auto end = corner + (part.sizes.empty() ? 3 : part.sizes[polygon]);
      corners.clear();
      for (; corner != end; ++corner) corners.push_back(first + *corner);
      builder_.add_face(corners);
    }
  }

  const FileView& file_;
  XmlScan scan_;
  XmlElements elements_;
  ColladaGeometries geometries_;
  std::map<std::string, std::string> sources_;  // of controllers: the geometry or controller that they move
  double metres_per_unit_ = 1;
  Placement axes_;
  std::vector<ColladaNode> nodes_;
  std::map<std::string, std::size_t> library_, in_scene_;
  std::optional<std::string> shown_;
  std::size_t scene_ = 0;
  std::vector<Size> measured_;
  MeshBuilder builder_;
};

bool is_dae(std::string_view content) { return content.substr(0, 1024).find("<COLLADA") != content.npos; }

Mesh read_dae(const FileView& file, MeshReadReport& report) { return ColladaReader(file).read(report); }

}  // namespace

constinit const MeshFormat kMeshDae{"dae", "DAE", "COLLADA", is_dae, read_dae, nullptr, false, Axis::y};

}  // namespace standoff
