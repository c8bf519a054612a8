// SPDX-License-Identifier: Apache-2.0
// 3MF: an archive of model parts; objects of triangles, objects of objects, and the build that places some of them.
#include <iterator>

#include "tests/grammar/hostile.h"
#include "tests/grammar/packed.h"
#include "tests/grammar/shape.h"
#include "tests/grammar/transform.h"
#include "tests/grammar/xml.h"

namespace standoff::grammar {
namespace {

constexpr const char* kSpaces = "http://schemas.microsoft.com/3dmanufacturing/";
constexpr std::uint32_t kFirstHung = 1000;  // id of the first of objects that hold each other
constexpr const char* kSecond = "/3D/Objects/second.model";

class Threemf {
 public:
  explicit Threemf(Choices& c) : c_(c) {}

  File make() {
    const bool two = c_.one_in(3);
    Xml first = model(), second = model();
    Xml &objects = first.add(Xml("resources")), &others = second.add(Xml("resources"));
    if (c_.one_in(4)) objects.add(Xml("basematerials", {{"id", "900"}})).add(Xml("base", {{"name", "PLA"}}));
    for (std::uint32_t n = 1 + c_.below(3); n > 0; --n) {
      const bool away = two && c_.one_in(2);
      (away ? others : objects).add(mesh_object(away));
    }
    for (std::uint32_t n = c_.below(4); n > 0; --n) objects.add(assembly());
    const bool hung = c_.trick();
    if (hung) hang(objects);
    Xml& build = first.add(Xml("build"));
    const Transform axes = unit(first);
    for (std::uint32_t n = 1 + c_.below(3); n > 0; --n) build.add(placed("item", axes, file_.truth));
    if (hung) build.add(Xml("item", {{"objectid", std::to_string(kFirstHung)}}));
    second.add(Xml("build"));
    file_.bytes = make_zip(c_, members(first, two ? &second : nullptr));
    damage(c_, file_.bytes);
    return std::move(file_);
  }

 private:
  Xml model() {
    Xml made("model", {{"xml:lang", "en-US"},
                       {"xmlns", std::string(kSpaces) + "core/2015/02"},
                       {"xmlns:p", std::string(kSpaces) + "production/2015/06"}});
    if (c_.one_in(2)) made.set("requiredextensions", c_.trick() ? bad_number(c_) : "p");
    if (c_.one_in(3)) made.add(Xml("metadata", {{"name", "Application"}})).say("grammar");
    return made;
  }

  // Readers turn every build to y up and scale it to metres.
  Transform unit(Xml& root) {
    constexpr std::pair<const char*, double> kUnits[] = {{"millimeter", 0.001}, {"micron", 1e-6}, {"centimeter", 0.01},
                                                         {"inch", 0.0254},      {"foot", 0.3048}, {"meter", 1}};
    const std::uint32_t n = c_.below(1 + std::size(kUnits));
    const double metres = n < std::size(kUnits) ? kUnits[n].second : 0.001;
    if (n < std::size(kUnits)) root.set("unit", kUnits[n].first);
    return Rows{{{metres, 0, 0, 0}, {0, 0, metres, 0}, {0, -metres, 0, 0}}};
  }

  std::vector<std::pair<std::string, std::string>> members(const Xml& first, const Xml* second) {
    const bool comments = c_.one_in(2);
    const std::string name = c_.one_in(4) ? "3D/other.model" : "3D/3dmodel.model";
    Xml relations("Relationships", {{"xmlns", "http://schemas.openxmlformats.org/package/2006/relationships"}});
    if (c_.one_in(3)) relations.add(Xml("Relationship", {{"Target", "/Metadata/picture.png"}, {"Type", "thumbnail"}}));
    relations.add(Xml("Relationship", {{"Target", c_.trick() ? bad_path(c_) : "/" + name},
                                       {"Id", "rel0"},
                                       {"Type", std::string(kSpaces) + "2013/01/3dmodel"}}));
    std::vector<std::pair<std::string, std::string>> made{{"[Content_Types].xml", Xml("Types").text(c_, comments)},
                                                          {"_rels/.rels", relations.text(c_, comments)}};
    if (second) made.emplace_back(kSecond + 1, second->text(c_, comments));
    made.emplace_back(name, first.text(c_, comments));
    if (c_.one_in(4)) made.emplace_back("Metadata/picture.png", std::string(100, '\x89'));
    return made;
  }

  std::string id(std::size_t object) { return whole(c_, static_cast<std::int64_t>(object + 1)); }

  Xml mesh_object(bool away) {
    const Shape shape = make_shape(c_, Polygons::none, false);
    Xml made("object", {{"id", id(objects_.size())}, {"type", "model"}});
    if (c_.one_in(4)) made.add(Xml("metadatagroup")).add(Xml("metadata", {{"name", "a"}})).say("b");
    Xml& mesh = made.add(Xml("mesh"));
    Xml& vertices = mesh.add(Xml("vertices"));
    for (const Vec3& p : shape.points)
      vertices.add(Xml("vertex", {{"x", real(c_, p.x)}, {"y", real(c_, p.y)}, {"z", real(c_, p.z)}}));
    Xml& triangles = mesh.add(Xml("triangles"));
    for (const auto& face : shape.faces) {
      Xml& triangle = triangles.add(
          Xml("triangle", {{"v1", whole(c_, face[0])}, {"v2", whole(c_, face[1])}, {"v3", whole(c_, face[2])}}));
      if (c_.one_in(8)) triangle.set("pid", "900").set("p1", "0");
    }
    Object& object = objects_.emplace_back();
    object.away = away;
    add_triangles(shape, object.truth.triangles);
    return made;
  }

  // Of objects that are there already.
  Xml assembly() {
    Xml made("object", {{"id", id(objects_.size())}});
    Xml& components = made.add(Xml("components"));
    Object object;
    for (std::uint32_t n = 1 + c_.below(3); n > 0; --n) components.add(placed("component", Transform{}, object.truth));
    objects_.push_back(std::move(object));
    return made;
  }

  // An object at a place; a plain one where there are many triangles already.
  Xml placed(const char* name, const Transform& outer, Truth& all) {
    constexpr std::size_t kMost = 2000;  // assemblies of assemblies grow fast
    std::uint32_t which = c_.below(static_cast<std::uint32_t>(objects_.size()));
    if (all.triangles.size() + objects_[which].truth.triangles.size() > kMost) which = 0;
    Xml made(name, {{"objectid", id(which)}});
    if (objects_[which].away) made.set("p:path", c_.trick() ? bad_path(c_) : kSecond);
    const Transform own = c_.one_in(2) ? transform(made) : Transform{};
    if (c_.one_in(6)) made.set("p:UUID", "00000000-0000-0000-0000-000000000001");
    add_placed(objects_[which].truth, outer.after(own), Mirrored::turned_back, all);
    return made;
  }

  // Rows of a matrix for row vectors: columns of ours.
  Transform transform(Xml& node) {
    constexpr double kScales[] = {1, 2, 0.5, -1, 3};
    constexpr std::size_t kTurns[][3] = {{0, 1, 2}, {1, 2, 0}, {1, 0, 2}};
    const auto& turn = c_.pick(kTurns);
    Rows rows{};
    for (std::size_t r = 0; r < 3; ++r) {
      rows[r][turn[r]] = c_.pick(kScales);
      rows[r][3] = double(make_coordinate(c_, false));
    }
    std::string text;
    for (std::size_t column = 0; column < 4; ++column)
      for (const auto& row : rows)
        if (!c_.trick()) text += (text.empty() ? "" : " ") + real(c_, row[column]);
    node.set("transform", text);
    return rows;
  }

  // Objects that hold each other: in a chain, twice, in a circle.
  void hang(Xml& objects) {
    const std::uint32_t kind = c_.below(3), count = kind == 1 ? 10 + c_.below(60) : c_.many();
    for (std::uint32_t n = 0; n < count; ++n) {
      Xml& components = objects.add(Xml("object", {{"id", std::to_string(kFirstHung + n)}})).add(Xml("components"));
      const std::uint32_t next = kind == 2 ? (n + 1) % count : n + 1;
      for (int times = kind == 1 ? 2 : 1; times > 0; --times)
        components.add(Xml("component", {{"objectid", next < count ? std::to_string(kFirstHung + next) : "1"}}));
    }
  }

  struct Object {
    Truth truth;
    bool away = false;  // in the second part
  };

  Choices& c_;
  std::vector<Object> objects_;  // number n has the id n + 1
  File file_;
};

}  // namespace

File make_3mf(Choices& c) { return Threemf(c).make(); }

}  // namespace standoff::grammar
