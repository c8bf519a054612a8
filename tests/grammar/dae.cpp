// SPDX-License-Identifier: Apache-2.0
// COLLADA: sources and inputs, every kind of primitive, nodes that instance geometries and nodes, units and axes.
#include <cmath>
#include <numbers>

#include "tests/grammar/hostile.h"
#include "tests/grammar/shape.h"
#include "tests/grammar/transform.h"
#include "tests/grammar/xml.h"

namespace standoff::grammar {
namespace {

std::string at(const std::string& id) { return "#" + id; }

class Collada {
 public:
  explicit Collada(Choices& c) : c_(c) {}

  File make() {
    Xml root("COLLADA", {{"xmlns", "http://www.collada.org/2005/11/COLLADASchema"}, {"version", "1.4.1"}});
    root.add(asset());
    Xml& geometries = root.add(Xml("library_geometries"));
    for (std::uint32_t n = 1 + c_.below(3); n > 0; --n) geometries.add(geometry());
    if (c_.one_in(3)) root.add(library());
    Xml& scenes = root.add(Xml("library_visual_scenes"));
    Xml& scene = scenes.add(Xml("visual_scene", {{"id", "scene"}}));
    for (std::uint32_t n = 1 + c_.below(3); n > 0; --n) scene.add(node(axes_, 0));
    if (c_.trick()) hang(scene);
    Xml& shown = root.add(Xml("scene"));
    shown.add(Xml("instance_visual_scene", {{"url", at("scene")}}));
    if (c_.trick()) root.add(Xml("library_images")).add(Xml("image")).add(Xml("init_from")).say(bad_path(c_));
    // Numbers with comments between them are refused.
    const bool comments = c_.one_in(8);
    file_.may_be_refused |= comments;
    file_.bytes = root.text(c_, comments);
    damage(c_, file_.bytes);
    return std::move(file_);
  }

 private:
  // Every scene is turned to y up and scaled to metres.
  Xml asset() {
    Xml made("asset");
    if (c_.one_in(3)) {
      constexpr double kMeters[] = {1, 0.01, 0.0254, 1000};
      const double meter = c_.pick(kMeters);
      made.add(Xml("unit", {{"name", "unit"}, {"meter", text_of(meter)}}));
      axes_ = scaling({meter, meter, meter});
    }
    const std::uint32_t up = c_.below(4);
    constexpr const char* kUp[] = {"Y_UP", "X_UP", "Z_UP"};
    if (up < 3) made.add(Xml("up_axis")).say(kUp[up]);
    if (up == 1) axes_ = Transform(Rows{{{0, -1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}}}).after(axes_);
    if (up == 2) axes_ = Transform(Rows{{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}}}).after(axes_);
    return made;
  }

  static std::string text_of(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
  }
  std::string count(std::size_t n) { return whole(c_, static_cast<std::int64_t>(n)); }
  std::string space() { return c_.one_in(12) ? "\n\t" : " "; }

  // Three numbers a point, sometimes with more between the points.
  Xml source(const std::string& id, const std::vector<Vec3>& points) {
    const std::size_t stride = c_.one_in(6) ? 4 : 3;
    std::string numbers;
    for (const Vec3& p : points) {
      for (const double x : {p.x, p.y, p.z}) numbers += real(c_, x) + space();
      if (stride == 4) numbers += "7 ";
    }
    Xml made("source", {{"id", id}});
    made.add(Xml("float_array", {{"id", id + "-array"}, {"count", count(points.size() * stride)}})).say(numbers);
    Xml& accessor = made.add(Xml("technique_common"))
                        .add(Xml("accessor", {{"source", at(id + "-array")}, {"count", count(points.size())}}));
    if (stride == 4 || !c_.trick()) accessor.set("stride", count(stride));
    if (c_.trick()) accessor.set("offset", count(c_.below(5)));
    for (const char* axis : {"X", "Y", "Z"}) accessor.add(Xml("param", {{"name", axis}, {"type", "float"}}));
    return made;
  }

  Xml geometry() {
    auto& triangles = geometries_.emplace_back().triangles;
    const std::string id = "g" + std::to_string(geometries_.size() - 1);
    const Shape shape = make_shape(c_, Polygons::some, false);
    Xml made("geometry", {{"id", id}, {"name", id}});
    Xml& mesh = made.add(Xml("mesh"));
    mesh.add(source(id + "-p", shape.points));
    const bool normals = c_.one_in(3);
    if (normals) mesh.add(source(id + "-n", std::vector<Vec3>(4, Vec3{0, 0, 1})));
    mesh.add(Xml("vertices", {{"id", id + "-v"}}))
        .add(Xml("input", {{"semantic", "POSITION"}, {"source", at(id + "-p")}}));
    for (std::uint32_t n = 1 + c_.below(2); n > 0; --n) mesh.add(primitive(id, shape, normals, triangles));
    return made;
  }

  enum PrimitiveKind : std::uint32_t { kTriangles, kPolylist, kPolygons, kStrips, kFans };

  // Strips and fans are of any points, polygons of those in a plane.
  std::vector<std::vector<std::uint32_t>> faces_of(const Shape& shape, std::uint32_t kind) {
    std::vector<std::vector<std::uint32_t>> faces;
    const bool longer = kind == kStrips || (kind == kFans && c_.one_in(6));
    for (const auto& face : shape.faces) {
      if (face.size() < 3 || (kind != kPolylist && kind != kPolygons && face.size() != 3)) continue;
      faces.push_back(face);
      if (longer)
        for (std::uint32_t n = c_.below(4); n > 0; --n)
          faces.back().push_back(c_.below(static_cast<std::uint32_t>(shape.points.size())));
    }
    return faces;
  }

  // The faces of a shape, as one of the kinds there are.
  Xml primitive(const std::string& id, const Shape& shape, bool normals, std::vector<Corners>& triangles) {
    constexpr const char* kKinds[] = {"triangles", "polylist", "polygons", "tristrips", "trifans"};
    const std::uint32_t kind = c_.below(5);
    Xml made(kKinds[kind]);
    const std::uint32_t vertex_at = normals && c_.one_in(2) ? 1 : 0;
    made.add(Xml("input", {{"semantic", "VERTEX"}, {"source", at(id + "-v")}, {"offset", count(vertex_at)}}));
    if (normals)
      made.add(Xml("input", {{"semantic", "NORMAL"}, {"source", at(id + "-n")}, {"offset", count(1 - vertex_at)}}));
    std::string sizes, indices;
    std::vector<std::string> lists;
    for (const auto& face : faces_of(shape, kind)) {
      std::string list;
      for (const auto corner : face) {
        std::string pair[] = {whole(c_, corner) + space(), normals ? std::to_string(c_.below(4)) + " " : ""};
        list += pair[vertex_at] + pair[1 - vertex_at];
      }
      indices += list;
      lists.push_back(list);
      sizes += count(face.size()) + " ";
      for (std::size_t k = 0; k + 2 < face.size(); ++k) {
        const bool strip = kind == kStrips, turned = strip && k % 2 == 1;
        const auto a = strip ? face[k] : face[0], b = face[turned ? k + 2 : k + 1], d = face[turned ? k + 1 : k + 2];
        triangles.push_back({shape.points[a], shape.points[b], shape.points[d]});
      }
    }
    made.set("count", count(lists.size()));
    if (kind == kPolylist) made.add(Xml("vcount")).say(sizes);
    if (kind <= kPolylist)
      made.add(Xml("p")).say(indices);
    else
      for (const std::string& list : lists) made.add(Xml("p")).say(list);
    return made;
  }

  // Nodes that others instance, each only those before it.
  Xml library() {
    Xml made("library_nodes");
    for (std::uint32_t n = 1 + c_.below(3); n > 0; --n) {
      const Truth before = std::exchange(file_.truth, {});
      Xml one = node(Transform{}, 1);
      const std::string id = "l" + std::to_string(kept_.size());
      made.add(one.set("id", id));
      kept_.push_back(std::move(file_.truth));
      file_.truth = before;
    }
    return made;
  }

  Xml node(const Transform& outer, int depth) {
    Xml made("node");
    if (depth == 0 && c_.one_in(2)) made.set("name", "node");
    Transform own = outer;
    for (std::uint32_t n = c_.below(4); n > 0; --n) own = own.after(place(made));
    const bool room = file_.truth.triangles.size() < kMost;
    if ((depth == 0 || c_.one_in(2)) && room) {
      const std::uint32_t which = c_.below(static_cast<std::uint32_t>(geometries_.size()));
      made.add(Xml("instance_geometry", {{"url", at("g" + std::to_string(which))}}));
      show(geometries_[which], own);
    }
    if (!kept_.empty() && c_.one_in(3) && room) {
      const std::uint32_t which = c_.below(static_cast<std::uint32_t>(kept_.size()));
      made.add(Xml("instance_node", {{"url", at("l" + std::to_string(which))}}));
      show(kept_[which], own);
    }
    if (c_.trick()) made.add(Xml("instance_node", {{"url", c_.one_in(2) ? at("l0") : bad_path(c_)}}));
    if (depth < 4)
      for (std::uint32_t n = c_.below(3); n > 0; --n) made.add(node(own, depth + 1));
    return made;
  }

  Transform place(Xml& node) {
    const auto list = [&](std::initializer_list<double> values) {
      std::string text;
      for (const double value : values) text += real(c_, value) + space();
      return text;
    };
    const auto component = [&] { return double(make_coordinate(c_, false)); };
    switch (c_.below(4)) {
      case 0: {
        const Vec3 by{component(), component(), component()};
        node.add(Xml("translate", {{"sid", "t"}})).say(list({by.x, by.y, by.z}));
        return translation(by);
      }
      case 1: {
        constexpr double kScales[] = {1, 2, 0.5, -1, 3};
        const Vec3 by{c_.pick(kScales), c_.pick(kScales), c_.pick(kScales)};
        node.add(Xml("scale")).say(list({by.x, by.y, by.z}));
        return scaling(by);
      }
      case 2: {
        const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.6, 0, 0.8}};
        const Vec3 axis = c_.pick(axes);
        const double angle_deg = 15 * double(c_.below(24));
        node.add(Xml("rotate")).say(list({axis.x, axis.y, axis.z, angle_deg}));
        return rotation_about(axis, angle_deg * std::numbers::pi / 180);
      }
      default: {
        Rows rows;
        std::string text;
        for (std::size_t r = 0; r < 3; ++r)
          for (double& value : rows[r]) {
            value = (double(c_.below(9)) - 4) / 2;
            // Nothing is to collapse.
            if (&value == &rows[r][r]) value += 8;
            text += real(c_, value) + space();
          }
        node.add(Xml("matrix")).say(text + "0 0 0 1");
        return rows;
      }
    }
  }

  static constexpr std::size_t kMost = 400;  // triangles: instances of instances grow fast

  void show(const Truth& part, const Transform& to) { add_placed(part, to, Mirrored::as_it_is, file_.truth); }

  // Nodes that instance each other: in a chain, twice, in a circle.
  void hang(Xml& scene) {
    const std::uint32_t kind = c_.below(3), nodes = kind == 1 ? 10 + c_.below(60) : c_.many();
    for (std::uint32_t n = 0; n < nodes; ++n) {
      Xml& made = scene.add(Xml("node", {{"id", "h" + std::to_string(n)}}));
      const std::uint32_t next = kind == 2 ? (n + 1) % nodes : n + 1;
      if (next >= nodes) made.add(Xml("instance_geometry", {{"url", "#g0"}}));
      for (int times = kind == 1 ? 2 : 1; times > 0 && next < nodes; --times)
        made.add(Xml("instance_node", {{"url", at("h" + std::to_string(next))}}));
    }
  }

  Choices& c_;
  Transform axes_;
  std::vector<Truth> geometries_, kept_;  // a geometry's triangles as they are, a library node's as it places them
  File file_;
};

}  // namespace

File make_dae(Choices& c) { return Collada(c).make(); }

}  // namespace standoff::grammar
