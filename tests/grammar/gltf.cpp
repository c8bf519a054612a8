// SPDX-License-Identifier: Apache-2.0
// glTF 2.0 as JSON and as GLB: buffers of every kind, views with strides and offsets, indexed and plain triangles,
// strips and fans, trees of nodes.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/grammar/hostile.h"
#include "tests/grammar/json.h"
#include "tests/grammar/shape.h"
#include "tests/grammar/transform.h"

namespace standoff::grammar {
namespace {

// Buffers, views and accessors.
class GltfData {
 public:
  GltfData(Choices& c, bool binary);

  // Adds numbers and returns the number of their accessor.
  Json positions(const std::vector<Vec3>& points);
  Json indices(const std::vector<std::uint32_t>& numbers, std::size_t points);

  // Moves all into the document, and files of buffers beside the file.
  void finish(Json& json, File& file);
  // The bytes of the first buffer, where that is GLB's own.
  const std::string& chunk() const { return chunk_; }

 private:
  Json accessor(const std::vector<std::string>& elements, std::uint32_t component, const char* type, bool may_stride);

  Choices& c_;
  bool binary_;
  std::vector<std::string> buffers_;
  std::string chunk_;
  Json views_ = Json::list(), accessors_ = Json::list();
};

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (at + k < bytes.size() ? static_cast<unsigned char>(bytes[at + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += at + k <= bytes.size() ? kDigits[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

Json counted(Choices& c, std::uint64_t value) { return Json::literal(whole(c, static_cast<std::int64_t>(value))); }

GltfData::GltfData(Choices& c, bool binary) : c_(c), binary_(binary), buffers_(1 + c.below(3)) {}

Json GltfData::positions(const std::vector<Vec3>& points) {
  std::vector<std::string> elements;
  Vec3 low = points[0], high = low;
  for (const Vec3& p : points) {
    std::string element;
    for (const double x : {p.x, p.y, p.z}) element += raw(stored(c_, static_cast<float>(x)));
    elements.push_back(element);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  constexpr std::uint32_t kFloat = 5126;
  const Json number = accessor(elements, kFloat, "VEC3", true);
  Json& made = accessors_.items().back();
  for (const auto& [name, at] : {std::pair("min", low), std::pair("max", high)}) {
    made[name] = Json::list();
    for (const double x : {at.x, at.y, at.z}) made[name].push(Json::literal(real(c_, x)));
  }
  return number;
}

Json GltfData::indices(const std::vector<std::uint32_t>& numbers, std::size_t points) {
  constexpr std::uint32_t kByte = 5121, kShort = 5123, kInt = 5125;
  std::uint32_t component = c_.one_in(3) ? kInt : points < 250 && c_.one_in(2) ? kByte : kShort;
  std::vector<std::string> elements;
  for (const std::uint32_t number : numbers)
    elements.push_back(component == kByte    ? raw(stored(c_, static_cast<std::uint8_t>(number)))
                       : component == kShort ? raw(stored(c_, static_cast<std::uint16_t>(number)))
                                             : raw(stored(c_, number)));
  return accessor(elements, component, "SCALAR", false);
}

// A view of its own, some bytes into the buffer, some bytes before the first number and between them.
Json GltfData::accessor(const std::vector<std::string>& elements, std::uint32_t component, const char* type,
                        bool may_stride) {
  const std::size_t which = c_.below(static_cast<std::uint32_t>(buffers_.size())), width = elements[0].size();
  std::string& buffer = buffers_[which];
  buffer.resize((buffer.size() + 3) / 4 * 4 + 4 * c_.below(3));
  if (c_.trick()) buffer += "x";
  const std::size_t begin = buffer.size(), before = c_.one_in(4) ? 4 * (1 + c_.below(4)) : 0;
  const bool strides = may_stride && c_.one_in(3);
  const std::size_t stride = strides ? (width + 3) / 4 * 4 + 4 * c_.below(4) : width;
  buffer.append(before, '\xee');
  for (std::size_t n = 0; n < elements.size(); ++n) {
    buffer += elements[n];
    if (n + 1 < elements.size()) buffer.append(stride - width, '\xdd');
  }
  Json view, made;
  view["buffer"] = counted(c_, which);
  if (begin > 0 || c_.one_in(2)) view["byteOffset"] = counted(c_, begin);
  view["byteLength"] = counted(c_, buffer.size() - begin);
  if (strides) view["byteStride"] = counted(c_, stride);
  made["bufferView"] = counted(c_, views_.size());
  if (before > 0 || c_.one_in(2)) made["byteOffset"] = counted(c_, before);
  made["componentType"] = c_.trick() ? Json(5118 + c_.below(14)) : Json(component);
  made["count"] = counted(c_, elements.size());
  constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4", "VEC5", ""};
  made["type"] = c_.trick() ? c_.pick(kTypes) : type;
  if (c_.trick()) {
    made["sparse"]["count"] = counted(c_, 1);
    made["sparse"]["indices"]["bufferView"] = counted(c_, 0);
    made["sparse"]["values"]["bufferView"] = counted(c_, 0);
  }
  if (c_.trick()) made["normalized"] = Json::literal("true");
  views_.push(std::move(view));
  accessors_.push(std::move(made));
  return counted(c_, accessors_.size() - 1);
}

void GltfData::finish(Json& json, File& file) {
  Json list = Json::list();
  for (std::size_t n = 0; n < buffers_.size(); ++n) {
    const std::string& bytes = buffers_[n];
    Json buffer;
    buffer["byteLength"] = counted(c_, std::max<std::size_t>(bytes.size(), 1));
    const std::string content = bytes.empty() ? std::string(1, '\0') : bytes;
    if (binary_ && n == 0) {
      chunk_ = content;
      if (c_.trick()) buffer["uri"] = bad_path(c_);
    } else if (c_.trick()) {
      buffer["uri"] = bad_path(c_);
    } else if (c_.one_in(4)) {
      const std::string name = "data" + std::to_string(n) + ".bin";
      buffer["uri"] = name;
      file.beside.emplace_back(name, content);
    } else {
      constexpr const char* kHeads[] = {"data:application/octet-stream;base64,",
                                        "data:application/gltf-buffer;base64,"};
      std::string uri = word(c_, c_.pick(kHeads)) + base64(content);
      if (c_.trick()) damage(c_, uri);
      buffer["uri"] = uri;
    }
    list.push(std::move(buffer));
  }
  json["buffers"] = std::move(list);
  json["bufferViews"] = std::move(views_);
  json["accessors"] = std::move(accessors_);
}

// The header and the chunks.
std::string make_glb_bytes(Choices& c, std::string json, const std::string& data) {
  const auto chunk = [&](std::string bytes, const std::string& type, char padding) {
    if (!c.trick()) bytes.resize((bytes.size() + 3) / 4 * 4, padding);
    return raw(stored(c, static_cast<std::uint32_t>(bytes.size()))) + word(c, type) + bytes;
  };
  std::string body = chunk(std::move(json), "JSON", ' ');
  if (c.trick()) body += chunk("{}", "JSON", ' ');
  if (!c.trick()) body += chunk(data, std::string("BIN\0", 4), '\0');
  if (c.one_in(8)) body += raw(std::uint32_t{4}) + "EXTRdata";
  return word(c, "glTF") + raw(stored(c, std::uint32_t{2})) +
         raw(stored(c, static_cast<std::uint32_t>(12 + body.size()))) + body;
}

// Hangs more nodes onto the last root of the last scene: a chain deeper than a stack, nodes that list the next one
// twice and so stand for 2^40, a circle, one child a hundred thousand times.
void hang(Json& json, Choices& c) {
  Json& nodes = json["nodes"];
  auto next = static_cast<std::uint32_t>(nodes.size());
  json["scenes"].items().back()["nodes"].push(next);
  const std::uint32_t kind = c.below(4), count = kind == 1 ? 10 + c.below(60) : c.many();
  for (std::uint32_t n = 0; n < count; ++n, ++next) {
    Json node, children = Json::list();
    const bool last = n + 1 == count;
    if (kind == 0 && !last) children.push(next + 1);
    if (kind == 1 && !last) children.push(next + 1), children.push(next + 1);
    if (kind == 2) children.push(last ? next + 1 - count : next + 1);
    if (kind == 3 && n == 0)
      for (std::uint32_t k = 0; k < count; ++k) children.push(next + 1);
    if (last) node["mesh"] = 0;
    if (children.size() > 0) node["children"] = std::move(children);
    nodes.push(std::move(node));
    if (kind == 3 && n == 1) return;
  }
}

constexpr std::uint32_t kTriangles = 4, kStrip = 5, kFan = 6;

class Gltf {
 public:
  Gltf(Choices& c, bool binary) : c_(c), binary_(binary), data_(c, binary) {}

  File make() {
    json_["asset"]["version"] = "2.0";
    if (c_.one_in(3)) json_["asset"]["generator"] = "a grammar";
    // Roots that are no scene of ours are not shown: their meshes count for nothing.
    const std::uint32_t meshes = 1 + c_.below(3);
    for (std::uint32_t n = 0; n < meshes; ++n) make_mesh();
    make_nodes();
    if (c_.trick()) hang(json_, c_);
    data_.finish(json_, file_);
    decorate();
    std::string text = json_.text(c_);
    if (c_.trick()) text.insert(0, "\xef\xbb\xbf");
    file_.bytes = binary_ ? make_glb_bytes(c_, std::move(text), data_.chunk()) : text;
    damage(c_, file_.bytes);
    return std::move(file_);
  }

 private:
  void make_mesh() {
    auto& triangles = meshes_.emplace_back();
    Json mesh, primitives = Json::list();
    for (std::uint32_t n = 1 + c_.below(3); n > 0; --n) primitives.push(primitive(triangles));
    mesh["primitives"] = std::move(primitives);
    if (c_.one_in(3)) mesh["name"] = "mesh";
    member_list("meshes").push(std::move(mesh));
  }

  Json primitive(std::vector<Corners>& triangles) {
    Json made;
    constexpr std::uint32_t kModes[] = {kTriangles, kTriangles, kStrip, kFan};
    const std::uint32_t mode = c_.pick(kModes);
    std::vector<Vec3> points;
    std::vector<std::uint32_t> indices;
    const bool indexed = !c_.one_in(4);
    const Shape shape = make_shape(c_, Polygons::none, false);
    if (indexed) {
      points = shape.points;
      for (const auto& face : shape.faces) indices.insert(indices.end(), face.begin(), face.end());
      made["indices"] = data_.indices(indices, points.size());
    } else {
      for (const auto& face : shape.faces)
        for (const auto corner : face) points.push_back(shape.points[corner]);
      for (std::uint32_t k = 0; k < points.size(); ++k) indices.push_back(k);
    }
    made["attributes"]["POSITION"] = data_.positions(points);
    if (c_.one_in(4)) made["attributes"]["NORMAL"] = data_.positions(std::vector<Vec3>(points.size(), Vec3{0, 0, 1}));
    if (mode != kTriangles || c_.one_in(2)) made["mode"] = c_.trick() ? c_.below(9) : mode;
    if (c_.one_in(6)) made["material"] = 0;
    const std::size_t step = mode == kTriangles ? 3 : 1;
    for (std::size_t k = 0; k + 2 < indices.size(); k += step) {
      const bool turned = mode == kStrip && k % 2 == 1;
      const std::size_t a = mode == kFan ? 0 : k, b = turned ? k + 2 : k + 1, d = turned ? k + 1 : k + 2;
      triangles.push_back({points[indices[a]], points[indices[b]], points[indices[d]]});
    }
    return made;
  }

  static constexpr std::size_t kMost = 400;  // triangles: more are not compared at leisure

  // Each node hangs on one before it, or is a root of the scene, or of none.
  void make_nodes() {
    const std::uint32_t count = 1 + c_.below(8);
    std::vector<Transform> world(count);
    std::vector<bool> shown(count);
    Json roots = Json::list();
    std::vector<Json> children(count, Json::list());
    std::vector<Json> nodes(count);
    for (std::uint32_t n = 0; n < count; ++n) {
      const Transform own = place(nodes[n]);
      const std::uint32_t parent = n == 0 ? 0 : c_.below(n + 1);
      if (n > 0 && parent < n) {
        children[parent].push(n);
        if (c_.trick()) children[n].push(parent);
        shown[n] = shown[parent];
        world[n] = world[parent].after(own);
      } else {
        shown[n] = n == 0 || !c_.one_in(4);
        if (shown[n]) roots.push(n);
        world[n] = own;
      }
      if ((n == 0 || c_.one_in(2)) && file_.truth.triangles.size() < kMost) {
        const std::uint32_t mesh = c_.below(static_cast<std::uint32_t>(meshes_.size()));
        nodes[n]["mesh"] = mesh;
        if (shown[n]) show(meshes_[mesh], world[n]);
      }
    }
    for (std::uint32_t n = 0; n < count; ++n) {
      if (children[n].size() > 0) nodes[n]["children"] = children[n];
      member_list("nodes").push(std::move(nodes[n]));
    }
    Json scene;
    scene["nodes"] = std::move(roots);
    const bool second = c_.one_in(4);
    if (second) member_list("scenes").push(Json());
    member_list("scenes").push(std::move(scene));
    json_["scene"] = second ? 1 : 0;
  }

  // What a mirror turns inside out is to be turned back (glTF 2.0, 3.7.4).
  void show(const std::vector<Corners>& triangles, const Transform& at) {
    Truth part;
    part.triangles = triangles;
    add_placed(part, at, Mirrored::turned_back, file_.truth);
  }

  static Json number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", value);
    return Json::literal(text);
  }
  double component() { return make_coordinate(c_, false); }

  Transform place(Json& node) {
    const std::uint32_t parts = c_.below(9);
    if (parts == 8) {
      Rows rows;
      for (std::size_t r = 0; r < 3; ++r)
        for (double& value : rows[r]) {
          value = (double(c_.below(17)) - 8) / 4;
          // Nothing is to collapse, or it could be mirrored or not.
          if (&value == &rows[r][r]) value = c_.one_in(3) ? value - 7 : value + 7;
        }
      Json matrix = Json::list();
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t r = 0; r < 4; ++r) matrix.push(number(r < 3 ? rows[r][k] : k == 3));
      node["matrix"] = std::move(matrix);
      return rows;
    }
    Transform made;
    const auto vector = [&](const char* name, std::initializer_list<double> values) {
      Json list = Json::list();
      for (const double value : values) list.push(number(value));
      node[name] = std::move(list);
    };
    if (parts & 1) {
      const Vec3 by{component(), component(), component()};
      vector("translation", {by.x, by.y, by.z});
      made = made.after(translation(by));
    }
    if (parts & 2) {
      const double x = component(), y = component(), z = component(), w = component() + 200;
      const double length = std::sqrt(x * x + y * y + z * z + w * w);
      vector("rotation", {x / length, y / length, z / length, w / length});
      made = made.after(rotation(x / length, y / length, z / length, w / length));
    }
    if (parts & 4) {
      constexpr double kScales[] = {1, 2, 0.5, -1, 1e-3, 3};
      const Vec3 by{c_.pick(kScales), c_.pick(kScales), c_.pick(kScales)};
      vector("scale", {by.x, by.y, by.z});
      made = made.after(scaling(by));
    }
    return made;
  }

  // What readers of meshes pass over.
  void decorate() {
    if (!c_.trick()) member_list("materials").push(Json());
    if (c_.one_in(6)) json_["extras"]["any"] = "thing";
    if (c_.one_in(8)) {
      json_["extensionsUsed"] = Json::list();
      json_["extensionsUsed"].push("EXT_nobody_knows");
    }
    if (c_.trick()) {
      json_["extensionsRequired"] = Json::list();
      json_["extensionsRequired"].push(c_.one_in(2) ? "KHR_draco_mesh_compression" : "EXT_nobody_knows");
    }
    if (c_.trick()) member_list("images").push(Json())["uri"] = bad_path(c_);
    if (c_.trick()) member_list("skins").push(Json())["joints"] = Json::list();
    if (c_.trick()) member_list("animations").push(Json());
    if (c_.trick()) member_list("cameras").push(Json())["type"] = "perspective";
  }

  Json& member_list(const char* name) {
    Json& found = json_[name];
    if (found.size() == 0) found = Json::list();
    return found;
  }

  Choices& c_;
  bool binary_;
  Json json_;
  GltfData data_;
  std::vector<std::vector<Corners>> meshes_;
  File file_;
};

}  // namespace

File make_gltf(Choices& c) { return Gltf(c, false).make(); }
File make_glb(Choices& c) { return Gltf(c, true).make(); }

}  // namespace standoff::grammar
