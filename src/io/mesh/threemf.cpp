// SPDX-License-Identifier: Apache-2.0
// 3MF: the triangles of what a file builds, where its items and components place them.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "files/file_view.h"
#include "files/text.h"
#include "files/zip.h"
#include "io/mesh/builder.h"
#include "io/mesh/format.h"
#include "io/mesh/scene.h"
#include "io/mesh/writers.h"
#include "standoff/error.h"
#include "standoff/mesh.h"

namespace standoff {
namespace {

/// Parts are unpacked when they are asked for, once, and kept. Errors everywhere: input; limit, where the parts that
/// were asked for unpack to more than a packed file of this size may hold.
class ThreemfPackage {
 public:
  /// The file must outlive it.
  explicit ThreemfPackage(const FileView& file);

  /// The bytes of a part, under the name FILE:PART. Names differ in more than the case of letters; a slash in front
  /// means nothing.
  const FileView& part(std::string_view name);
  /// The part that the package names as its 3D model. Encrypted packages are refused.
  const FileView& model();
  /// Bytes of all parts that were asked for.
  std::uint64_t unpacked() const { return unpacked_; }

 private:
  struct Entry {
    ZipMember member;
    std::unique_ptr<ZipMemberStream> stream;  // owns the bytes, where they were packed
    std::unique_ptr<FileView> part;
  };

  Entry* find(std::string_view name);
  const FileView& unpack(Entry& entry);

  const FileView& file_;
  std::map<std::string, Entry> entries_;  // by their names in lower case
  std::uint64_t unpacked_ = 0;
};

std::string key(std::string_view name) {
  if (name.starts_with('/')) name.remove_prefix(1);
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return lower;
}

ThreemfPackage::ThreemfPackage(const FileView& file) : file_(file) {
  for (ZipMember& member : read_zip(file)) {
    std::string name = key(member.name);
    const auto [entry, is_new] = entries_.try_emplace(std::move(name));
    if (!is_new) file.fail(shown(member.name), "the archive holds this part twice; write the file again");
    entry->second.member = std::move(member);
  }
}

ThreemfPackage::Entry* ThreemfPackage::find(std::string_view name) {
  const auto found = entries_.find(key(name));
  return found == entries_.end() ? nullptr : &found->second;
}

const FileView& ThreemfPackage::part(std::string_view name) {
  Entry* entry = find(name);
  if (!entry) file_.fail("", "the archive holds no part " + in_quotes(name) + "; get all of it, or write it again");
  return unpack(*entry);
}

const FileView& ThreemfPackage::unpack(Entry& entry) {
  if (entry.part) return *entry.part;
  const ZipMember& member = entry.member;
  const std::uint64_t most = most_unpacked(file_.size());
  if (member.bytes > most - unpacked_)
    throw Error(ErrorCode::limit, file_.path().string() + ":" + shown(member.name) +
                                      ": with it the file unpacks to more than " + std::to_string(most >> 20) +
                                      " MiB, where one of its size may have no more; write the mesh as STL or PLY");
  unpacked_ += member.bytes;
  entry.stream = std::make_unique<ZipMemberStream>(file_, member);
  entry.part = std::make_unique<FileView>(file_, file_.path().string() + ":" + shown(member.name),
                                          entry.stream->next(member.bytes));
  return *entry.part;
}

const FileView& ThreemfPackage::model() {
  constexpr std::string_view kModel = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
  std::string target = "3D/3dmodel.model";
  if (Entry* relations = find("_rels/.rels")) {
    XmlScan scan(unpack(*relations));
    XmlTag tag{};
    while (scan.next(tag)) {
      if (!tag.opens() || tag.local_name() != "Relationship") continue;
      const std::string_view type = tag.attribute("Type");
      if (type.ends_with("/keystore")) scan.fail("the file is encrypted; save it without protection");
      if (type == kModel) target = tag.attribute("Target");
    }
  }
  return part(target);
}

/// An object placed in another one, or in the build. Points into the part's text.
struct ThreemfReference {
  XmlTag tag;
  std::uint32_t object;
  std::string_view path;  ///< of the part that holds the object; empty: this part
};

struct ThreemfObject {
  /// Indices into the lists of the model: [first, end).
  struct Range {
    std::size_t first = 0, end = 0;
    std::size_t size() const { return end - first; }
  };
  Range vertices, triangles, components;
};

/// Everything is copied out of the text, or points into it.
class ThreemfModel {
 public:
  /// Errors: input, as `FILE:PART:line N: ...`. The part must outlive it.
  explicit ThreemfModel(const FileView& part);

  /// Throws with the reference's line where there is no such object.
  const ThreemfObject& find(const ThreemfReference& reference, const ThreemfModel& from) const;
  /// Where a reference of this model places its object. Errors: input.
  Placement placement(const ThreemfReference& reference) const;
  /// Throws with the line of a reference of this model.
  [[noreturn]] void fail_at(const ThreemfReference& reference, const std::string& message) const {
    scan_.fail_at(reference.tag, message);
  }

  double metres_per_unit = 0.001;
  std::vector<ThreemfReference> build;
  std::vector<ThreemfReference> components;  ///< of all objects
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;  ///< their corners count from the object's first vertex

 private:
  void check_extensions(const XmlTag& model) const;
  void read_unit(const XmlTag& model);
  void read_object(const XmlTag& tag);
  void read_mesh(const XmlTag& tag, ThreemfObject& object);
  void read_vertex(const XmlTag& tag);
  void read_triangle(const XmlTag& tag, std::size_t vertices);
  void read_reference(const XmlTag& tag, std::vector<ThreemfReference>& to);
  double coordinate(const XmlTag& tag, std::string_view name) const;
  std::uint32_t whole(const XmlTag& tag, std::string_view name) const;

  XmlScan scan_;
  XmlElements elements_;
  std::map<std::uint32_t, ThreemfObject> objects_;
};

constexpr int kDeepestModel = 100;  // elements; the specification needs seven

// Takes a number that a space or the end follows off the front. False where there is none.
template <class Number>
bool take(std::string_view& text, Number& number) {
  skip_space(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const auto length = static_cast<std::size_t>(end - text.data());
  if constexpr (std::is_floating_point_v<Number>) {
    if (error == std::errc::result_out_of_range)
      number = beyond_range(text.substr(0, length));
    else if (error != std::errc{})
      return false;
  } else if (error != std::errc{}) {
    return false;
  }
  text.remove_prefix(length);
  return text.empty() || is_space(text[0]);
}

// The number that is the whole attribute.
template <class Number>
bool is_number(std::string_view text, Number& number) {
  if (!take(text, number)) return false;
  skip_space(text);
  return text.empty();
}

std::string name_of(const XmlTag& tag) { return shown(tag.local_name()); }

ThreemfModel::ThreemfModel(const FileView& part)
    : scan_(part), elements_(scan_, kDeepestModel, "write the file again") {
  XmlTag model{};
  if (!scan_.next(model) || !model.opens() || model.local_name() != "model")
    scan_.fail("the part holds no element model; check the program that wrote the file");
  check_extensions(model);
  read_unit(model);
  elements_.each_child(model, [&](const XmlTag& tag) {
    if (tag.local_name() == "resources")
      elements_.each_child(tag, [&](const XmlTag& resource) {
        resource.local_name() == "object" ? read_object(resource) : elements_.skip(resource);
      });
    else if (tag.local_name() == "build")
      elements_.each_child(tag, [&](const XmlTag& item) {
        if (item.local_name() == "item") read_reference(item, build);
        elements_.skip(item);
      });
    else
      elements_.skip(tag);
  });
}

// A file names the extensions without which it is another shape by the prefixes of their namespaces.
void ThreemfModel::check_extensions(const XmlTag& model) const {
  constexpr std::string_view kRead[] = {"/3dmanufacturing/production/", "/3dmanufacturing/material/",
                                        "/3dmanufacturing/slice/", "/3dmanufacturing/trianglesets/"};
  std::string_view rest = model.attribute("requiredextensions");
  for (skip_space(rest); !rest.empty(); skip_space(rest)) {
    const auto length = static_cast<std::size_t>(std::ranges::find_if(rest, is_space) - rest.begin());
    const std::string prefix(rest.substr(0, length));
    rest.remove_prefix(length);
    const std::string_view space = model.attribute("xmlns:" + prefix);
    if (space.find("/3dmanufacturing/securecontent/") != space.npos)
      scan_.fail("the file is encrypted; save it without protection");
    if (std::ranges::none_of(kRead, [&](std::string_view known) { return space.find(known) != space.npos; }))
      scan_.fail("it cannot be read without the extension " + in_quotes(prefix) +
                 (space.empty() ? "" : " (" + shown(space, 100) + ")") +
                 ", which is not read here; write the file again without it, as triangles");
  }
}

void ThreemfModel::read_unit(const XmlTag& model) {
  constexpr std::pair<std::string_view, double> kUnits[] = {
      {"micron", 1e-6}, {"millimeter", 0.001}, {"centimeter", 0.01}, {"inch", 0.0254}, {"foot", 0.3048}, {"meter", 1}};
  const auto name = model.find("unit");
  if (!name) return;
  const auto found = std::ranges::find(kUnits, *name, [](const auto& unit) { return unit.first; });
  if (found == std::end(kUnits))
    scan_.fail("the unit " + in_quotes(*name) +
               " is none of micron, millimeter, centimeter, inch, foot, meter; repair the file");
  metres_per_unit = found->second;
}

void ThreemfModel::read_object(const XmlTag& tag) {
  const std::uint32_t id = whole(tag, "id");
  const auto [found, is_new] = objects_.try_emplace(id);
  if (!is_new) scan_.fail("object " + std::to_string(id) + " is there twice; repair the file");
  if (tag.find_local("meshresolution") == "lowres")
    scan_.fail("the mesh of object " + std::to_string(id) +
               " stands in for slices, which are not read; write the file again with its full mesh");
  ThreemfObject& object = found->second;
  object.vertices = {vertices.size(), vertices.size()};
  object.triangles = {triangles.size(), triangles.size()};
  object.components = {components.size(), components.size()};
  elements_.each_child(tag, [&](const XmlTag& child) {
    const std::string_view name = child.local_name();
    if (name == "mesh") return read_mesh(child, object);
    if (name == "metadatagroup") return elements_.skip(child);
    if (name != "components")
      scan_.fail("a shape by the element " + name_of(child) + " is not read; write the file again, as triangles");
    elements_.each_child(child, [&](const XmlTag& component) {
      if (component.local_name() == "component") read_reference(component, components);
      elements_.skip(component);
    });
    object.components.end = components.size();
  });
}

void ThreemfModel::read_mesh(const XmlTag& mesh, ThreemfObject& object) {
  if (object.vertices.size() > 0) scan_.fail("a second mesh in an object; give each an object of its own");
  elements_.each_child(mesh, [&](const XmlTag& list) {
    const std::string_view name = list.local_name();
    if (name == "beamlattice") scan_.fail("beams are not read; write the file again, as triangles");
    elements_.each_child(list, [&](const XmlTag& tag) {
      if (name == "vertices" && tag.local_name() == "vertex") read_vertex(tag);
      if (name == "triangles" && tag.local_name() == "triangle")
        read_triangle(tag, vertices.size() - object.vertices.first);
      elements_.skip(tag);
    });
  });
  object.vertices.end = vertices.size();
  object.triangles.end = triangles.size();
}

void ThreemfModel::read_vertex(const XmlTag& tag) {
  vertices.push_back({coordinate(tag, "x"), coordinate(tag, "y"), coordinate(tag, "z")});
}

void ThreemfModel::read_triangle(const XmlTag& tag, std::size_t count) {
  const Triangle corners{whole(tag, "v1"), whole(tag, "v2"), whole(tag, "v3")};
  for (const std::uint32_t corner : corners)
    if (corner >= count)
      scan_.fail("vertex index " + std::to_string(corner) + " is out of range, there are " + std::to_string(count) +
                 " vertices; repair the mesh");
  triangles.push_back(corners);
}

void ThreemfModel::read_reference(const XmlTag& tag, std::vector<ThreemfReference>& to) {
  to.push_back({tag, whole(tag, "objectid"), tag.find_local("path").value_or(std::string_view())});
}

double ThreemfModel::coordinate(const XmlTag& tag, std::string_view name) const {
  double number = 0;
  const std::string_view text = tag.attribute(name);
  if (!is_number(text, number) || !std::isfinite(number))
    scan_.fail("attribute " + std::string(name) + " must be a finite number, found " + in_quotes(text) +
               "; repair the mesh");
  return number;
}

std::uint32_t ThreemfModel::whole(const XmlTag& tag, std::string_view name) const {
  std::uint32_t number = 0;
  const std::string_view text = tag.attribute(name);
  if (!is_number(text, number))
    scan_.fail("attribute " + std::string(name) + " must be a whole number, found " + in_quotes(text) +
               "; repair the mesh");
  return number;
}

const ThreemfObject& ThreemfModel::find(const ThreemfReference& reference, const ThreemfModel& from) const {
  const auto found = objects_.find(reference.object);
  if (found == objects_.end())
    from.fail_at(reference, "there is no object " + std::to_string(reference.object) +
                                (reference.path.empty() ? "" : " in " + in_quotes(reference.path)) +
                                "; repair the file");
  return found->second;
}

// Four rows of three: row vectors are multiplied from the left, the shift is in the last row.
Placement ThreemfModel::placement(const ThreemfReference& reference) const {
  Placement placement;
  const auto transform = reference.tag.find("transform");
  if (!transform) return placement;
  std::string_view rest = *transform;
  for (std::size_t column = 0; column < 4; ++column)
    for (auto& row : placement.rows)
      if (!take(rest, row[column]) || !std::isfinite(row[column]))
        fail_at(reference,
                "a transform must be twelve finite numbers, found " + in_quotes(*transform) + "; repair the file");
  skip_space(rest);
  if (!rest.empty()) fail_at(reference, "a transform has more than twelve numbers; repair the file");
  return placement;
}

// Beyond any build that was meant. Each level takes a frame of the reader's stack; each placed object half a
// microsecond, also where it holds no triangle.
constexpr int kDeepestComponent = 200;
constexpr double kMostPlaced = 1e6;

class Build {
 public:
  Build(const FileView& file, ThreemfPackage& package)
      : file_(file), package_(package), root_(load(package.model())), builder_(file) {}

  double metres_per_unit() const { return root_.metres_per_unit; }

  Mesh read(const Placement& outer) {
    Size all;
    for (const ThreemfReference& item : root_.build) add(all, root_, item, 0);
    check_unfolded(file_, {all.vertices, all.triangles}, file_.size() + package_.unpacked());
    check_counts(file_, static_cast<std::uint64_t>(all.vertices), static_cast<std::uint64_t>(all.triangles));
    builder_.vertices.reserve(static_cast<std::size_t>(all.vertices));
    builder_.triangles.reserve(static_cast<std::size_t>(all.triangles));
    for (const ThreemfReference& item : root_.build) place(root_, item, outer);
    return builder_.finish([this](std::size_t vertex) { return where(vertex); });
  }

 private:
  // Of an object with all that its components place.
  struct Size {
    double vertices = 0, triangles = 0, placed = 0;
    int height = 0;
    bool entered = false, known = false;
  };
  // Vertices of the builder from `first` on are those of an object.
  struct Origin {
    std::size_t first;
    std::uint32_t object;
  };

  const ThreemfModel& load(const FileView& part) {
    auto& model = models_[&part];
    if (!model) model = std::make_unique<ThreemfModel>(part);
    return *model;
  }

  const ThreemfModel& model_of(const ThreemfReference& reference, const ThreemfModel& from) {
    return reference.path.empty() ? from : load(package_.part(reference.path));
  }

  void add(Size& sum, const ThreemfModel& from, const ThreemfReference& reference, int depth) {
    const ThreemfModel& model = model_of(reference, from);
    const ThreemfObject& object = model.find(reference, from);
    Size& size = sizes_[&object];
    if (!size.known) {
      if (size.entered) from.fail_at(reference, "an object is a component of itself; repair the file");
      if (depth > kDeepestComponent) fail_for_depth(from, reference);
      size.entered = true;
      Size inner{double(object.vertices.size()), double(object.triangles.size()), 1};
      for (std::size_t c = object.components.first; c < object.components.end; ++c)
        add(inner, model, model.components[c], depth + 1);
      size = inner;
      size.known = true;
    }
    if (size.height + depth > kDeepestComponent) fail_for_depth(from, reference);
    sum.height = std::max(sum.height, size.height + 1);
    sum.vertices += size.vertices;
    sum.triangles += size.triangles;
    sum.placed += size.placed;
    if (sum.placed > kMostPlaced)
      from.fail_at(reference, "its items and components place more than 1000000 objects; place fewer");
  }

  [[noreturn]] static void fail_for_depth(const ThreemfModel& from, const ThreemfReference& reference) {
    from.fail_at(reference,
                 "components are nested more than " + std::to_string(kDeepestComponent) + " deep; flatten them");
  }

  void place(const ThreemfModel& from, const ThreemfReference& reference, const Placement& outer) {
    const ThreemfModel& model = model_of(reference, from);
    const ThreemfObject& object = model.find(reference, from);
    const Placement placement = outer * from.placement(reference);
    // What was outside stays outside.
    const bool mirrored = placement.mirrors();
    const auto first = static_cast<std::uint32_t>(builder_.vertices.size());
    if (object.vertices.size() > 0) origins_.push_back({first, reference.object});
    for (std::size_t v = object.vertices.first; v < object.vertices.end; ++v)
      builder_.vertices.push_back(placement(model.vertices[v]));
    for (std::size_t t = object.triangles.first; t < object.triangles.end; ++t) {
      auto [a, b, c] = model.triangles[t];
      if (mirrored) std::swap(b, c);
      builder_.triangles.push_back({first + a, first + b, first + c});
    }
    for (std::size_t c = object.components.first; c < object.components.end; ++c)
      place(model, model.components[c], placement);
  }

  std::string where(std::size_t vertex) const {
    const auto after = std::ranges::upper_bound(origins_, vertex, {}, &Origin::first);
    if (after == origins_.begin()) return "vertex " + std::to_string(vertex);
    const Origin& origin = *std::prev(after);
    return "object " + std::to_string(origin.object) + " vertex " + std::to_string(vertex - origin.first);
  }

  const FileView& file_;
  ThreemfPackage& package_;
  std::map<const FileView*, std::unique_ptr<ThreemfModel>> models_;
  const ThreemfModel& root_;
  std::map<const ThreemfObject*, Size> sizes_;
  MeshBuilder builder_;
  std::vector<Origin> origins_;
};

// Names stand in an archive as they are.
bool is_3mf(std::string_view content) {
  return content.starts_with("PK\x03\x04") && content.find(".model") != content.npos &&
         content.find("_rels/.rels") != content.npos;
}

Mesh read_3mf(const FileView& file, MeshReadReport& report) {
  ThreemfPackage package(file);
  Build build(file, package);
  // As for 3DS and COLLADA: from z up to y up, in metres.
  const double scale = build.metres_per_unit();
  Mesh mesh = build.read({{{{scale, 0, 0, 0}, {0, 0, scale, 0}, {0, -scale, 0, 0}}}});
  report.axes = {1, 3, -2};
  report.unit_scale = scale;
  report.metres_per_unit = 1;
  return mesh;
}

}  // namespace

constinit const MeshFormat kMesh3mf{"3mf", "3MF",  "3D Manufacturing Format", is_3mf, read_3mf, write_3mf,
                                    true,  Axis::y};

}  // namespace standoff
