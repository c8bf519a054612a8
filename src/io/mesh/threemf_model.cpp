// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/threemf_model.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

#include "files/file_view.h"
#include "files/text_cursor.h"

namespace standoff {
namespace {

constexpr int kDeepestModel =
    100;  // elements; the specification needs seven, and each takes a frame of the reader's stack

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

}  // namespace

ThreemfModel::ThreemfModel(const FileView& part) : scan_(part) {
  XmlTag model{};
  if (!scan_.next(model) || !model.opens() || model.local_name() != "model")
    scan_.fail("the part holds no element model; check the program that wrote the file");
  check_extensions(model);
  read_unit(model);
  each_child(model, [&](const XmlTag& tag) {
    if (tag.local_name() == "resources")
      each_child(tag, [&](const XmlTag& resource) {
        resource.local_name() == "object" ? read_object(resource) : skip(resource);
      });
    else if (tag.local_name() == "build")
      each_child(tag, [&](const XmlTag& item) {
        if (item.local_name() == "item") read_reference(item, build);
        skip(item);
      });
    else
      skip(tag);
  });
}

template <class Visit>
void ThreemfModel::each_child(const XmlTag& parent, const Visit& visit) {
  if (parent.kind == XmlTag::Kind::whole) return;
  if (++depth_ > kDeepestModel)
    scan_.fail("elements nested more than " + std::to_string(kDeepestModel) + " deep; write the file again");
  XmlTag tag{};
  for (;;) {
    if (!scan_.next(tag))
      scan_.fail_at(parent, "the element " + name_of(parent) + " has no end; the part is cut off, get all of the file");
    if (!tag.opens()) break;
    visit(tag);
  }
  if (tag.name != parent.name)
    scan_.fail("the element " + name_of(parent) + " ends as " + name_of(tag) + "; repair the file");
  --depth_;
}

void ThreemfModel::skip(const XmlTag& tag) {
  each_child(tag, [this](const XmlTag& child) { skip(child); });
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
  each_child(tag, [&](const XmlTag& child) {
    const std::string_view name = child.local_name();
    if (name == "mesh") return read_mesh(child, object);
    if (name == "metadatagroup") return skip(child);
    if (name != "components")
      scan_.fail("a shape by the element " + name_of(child) + " is not read; write the file again, as triangles");
    each_child(child, [&](const XmlTag& component) {
      if (component.local_name() == "component") read_reference(component, components);
      skip(component);
    });
    object.components.end = components.size();
  });
}

void ThreemfModel::read_mesh(const XmlTag& mesh, ThreemfObject& object) {
  if (object.vertices.size() > 0) scan_.fail("a second mesh in an object; give each an object of its own");
  each_child(mesh, [&](const XmlTag& list) {
    const std::string_view name = list.local_name();
    if (name == "beamlattice") scan_.fail("beams are not read; write the file again, as triangles");
    each_child(list, [&](const XmlTag& tag) {
      if (name == "vertices" && tag.local_name() == "vertex") read_vertex(tag);
      if (name == "triangles" && tag.local_name() == "triangle")
        read_triangle(tag, vertices.size() - object.vertices.first);
      skip(tag);
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

}  // namespace standoff
