// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/dae_geometry.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <utility>

#include "files/file_view.h"
#include "files/text.h"

namespace standoff {
namespace {

constexpr std::uint64_t kMostNumber = (std::uint64_t{1} << 31) - 1;
constexpr std::uint64_t kMostOffset = 255;  // inputs of a primitive; files have up to ten

std::optional<std::uint64_t> whole_in(std::string_view word) {
  std::uint64_t number = 0;
  const char* end = word.data() + word.size();
  const auto [after, error] = std::from_chars(word.data(), end, number);
  if (error != std::errc{} || after != end || number > kMostNumber) return {};
  return number;
}

bool is_list_of_faces(std::string_view name) {
  constexpr std::string_view kKinds[] = {"triangles", "polylist", "polygons",  "trifans",
                                         "tristrips", "lines",    "linestrips"};
  return std::ranges::find(kKinds, name) != std::end(kKinds);
}

// Lines have vertices, but no faces.
void add_polygons(std::string_view kind, const std::vector<std::uint32_t>& sizes,
                  const std::vector<std::uint32_t>& corners, ColladaPart& part) {
  const auto triangles_of = [](std::size_t size) { return size < 3 ? 0 : size - 2; };
  if (kind == "tristrips" || kind == "trifans") {
    for (std::size_t n = 2; n < corners.size(); ++n) {
      const bool fan = kind == "trifans", odd = !fan && n % 2 == 1;
      const std::uint32_t a = corners[fan ? 0 : n - 2], b = corners[n - 1], c = corners[n];
      part.corners.insert(part.corners.end(), {odd ? b : a, odd ? a : b, c});
    }
    part.triangles = part.corners.size() / 3;
  } else if (kind == "triangles" || kind == "polylist" || kind == "polygons") {
    part.corners.insert(part.corners.end(), corners.begin(), corners.end());
    if (kind == "triangles") part.triangles = corners.size() / 3;
    if (kind == "polylist") part.sizes = sizes;
    if (kind == "polylist")
      for (const std::uint32_t size : sizes) part.triangles += triangles_of(size);
    if (kind == "polygons") part.sizes.push_back(static_cast<std::uint32_t>(corners.size()));
    if (kind == "polygons") part.triangles += triangles_of(corners.size());
  }
}

}  // namespace

std::optional<std::string> id_in(std::string_view reference) {
  std::string plain = plain_xml(reference);
  if (!plain.starts_with('#')) return std::nullopt;
  return plain.substr(1);
}

std::string_view take_xml_word(std::string_view& text) {
  skip_space(text);
  const auto length = static_cast<std::size_t>(std::ranges::find_if(text, is_space) - text.begin());
  const std::string_view word = text.substr(0, length);
  text.remove_prefix(length);
  return word;
}

std::optional<double> double_in(std::string_view word) {
  if (const auto comma = word.find(','); comma != word.npos) {
    std::string with_point(word);
    with_point[comma] = '.';
    return word.find('.') == word.npos ? double_in(with_point) : std::nullopt;
  }
  if (word.starts_with('+')) word.remove_prefix(1);
  double number = 0;
  const char* end = word.data() + word.size();
  const auto [after, error] = std::from_chars(word.data(), end, number);
  if (after != end || error == std::errc::invalid_argument) return std::nullopt;
  return error == std::errc{} ? number : beyond_range(word);
}

void ColladaGeometries::read(const XmlTag& tag) {
  ColladaGeometry geometry;
  int meshes = 0;
  elements_.each_child(tag, [&](const XmlTag& child) {
    if (child.name != "mesh") return elements_.skip(child);
    if (++meshes > 1) scan_.fail("a second mesh in a geometry; give each a geometry of its own");
    read_mesh(child, geometry);
  });
  for (const ColladaPart& part : geometry.parts) {
    geometry.vertices += part.vertices.size();
    geometry.triangles += part.triangles;
  }
  geometries_.emplace(plain_xml(tag.attribute("id")), std::move(geometry));
}

const ColladaGeometry* ColladaGeometries::find(const std::string& id) const {
  const auto found = geometries_.find(id);
  return found == geometries_.end() ? nullptr : &found->second;
}

void ColladaGeometries::read_mesh(const XmlTag& mesh, ColladaGeometry& geometry) {
  vertices_id_ = {};
  positions_source_.clear();
  positions_ = {};
  elements_.each_child(mesh, [&](const XmlTag& tag) {
    if (tag.name == "source")
      read_source(tag);
    else if (tag.name == "vertices")
      read_vertices(tag);
    else if (is_list_of_faces(tag.name))
      read_primitive(tag, geometry);
    else
      elements_.skip(tag);
  });
}

// Arrays are read once they are positions.
void ColladaGeometries::read_source(const XmlTag& source) {
  const std::string id = plain_xml(source.attribute("id"));
  elements_.each_child(source, [&](const XmlTag& tag) {
    if (tag.name == "float_array") arrays_[plain_xml(tag.attribute("id"))] = {tag, whole(tag, "count", 0)};
    if (tag.name != "technique_common") return elements_.skip(tag);
    elements_.each_child(
        tag, [&](const XmlTag& child) { child.name == "accessor" ? read_accessor(child, id) : elements_.skip(child); });
  });
}

void ColladaGeometries::read_accessor(const XmlTag& tag, const std::string& source) {
  Accessor accessor{id_in(tag.attribute("source")).value_or(""), whole(tag, "count", 0), whole(tag, "stride", 1),
                    whole(tag, "offset", 0)};
  elements_.each_child(tag, [&](const XmlTag& child) {
    if (child.name == "param") {
      constexpr std::string_view kNames = "XYZ";
      const std::string_view name = child.attribute("name");
      if (name.size() == 1 && kNames.find(name[0]) != kNames.npos)
        accessor.place[kNames.find(name[0])] = accessor.params;
      ++accessor.params;
    }
    elements_.skip(child);
  });
  accessors_.insert_or_assign(source, std::move(accessor));
}

void ColladaGeometries::read_vertices(const XmlTag& tag) {
  if (vertices_id_) scan_.fail("a second element vertices in a mesh; repair the mesh");
  vertices_id_ = plain_xml(tag.attribute("id"));
  elements_.each_child(tag, [&](const XmlTag& input) {
    if (input.name == "input" && input.attribute("semantic") == "POSITION")
      positions_source_ = id_in(input.attribute("source")).value_or("");
    elements_.skip(input);
  });
}

void ColladaGeometries::read_primitive(const XmlTag& tag, ColladaGeometry& geometry) {
  Primitive primitive;
  primitive.kind = tag.name;
  primitive.count = whole(tag, "count", 0);
  ColladaPart part;
  elements_.each_child(tag, [&](const XmlTag& child) {
    if (child.name == "input") read_input(child, primitive);
    if (child.name == "vcount") read_sizes(child, primitive);
    if (child.name == "p") {
      ++primitive.lists;
      add_polygons(primitive.kind, primitive.sizes, read_corners(child, primitive, part), part);
    }
    if (child.name == "ph") scan_.fail("polygons with holes (ph) are not read; triangulate the mesh");
    if (is_list_of_faces(child.name)) scan_.fail("a list of faces inside of another; repair the mesh");
    elements_.skip(child);
  });
  check_lists(primitive);
  if (!part.vertices.empty()) geometry.parts.push_back(std::move(part));
}

void ColladaGeometries::read_input(const XmlTag& tag, Primitive& primitive) const {
  const std::uint64_t offset = whole(tag, "offset", 0);
  if (offset > kMostOffset) scan_.fail("an offset of " + std::to_string(offset) + "; repair the file");
  primitive.offsets = std::max(primitive.offsets, offset + 1);
  if (tag.attribute("semantic") != "VERTEX") return;
  primitive.has_vertices = true;
  primitive.vertex_offset = offset;
  primitive.vertices = id_in(tag.attribute("source")).value_or("");
}

void ColladaGeometries::read_sizes(const XmlTag& tag, Primitive& primitive) const {
  each_whole(tag, [&](std::uint64_t size) {
    primitive.sizes.push_back(static_cast<std::uint32_t>(size));
    primitive.corners += size;
  });
}

// Of each corner the number of its vertex in the part, which gets those that are new.
std::vector<std::uint32_t> ColladaGeometries::read_corners(const XmlTag& tag, Primitive& primitive, ColladaPart& part) {
  constexpr std::uint32_t kNew = std::numeric_limits<std::uint32_t>::max();
  if (!primitive.has_vertices) scan_.fail("no input before the indices is called VERTEX; repair the file");
  find_positions(primitive);
  primitive.number.resize(positions_->size(), kNew);
  std::vector<std::uint32_t> corners;
  std::uint64_t indices = 0;
  each_whole(tag, [&](std::uint64_t index) {
    if (indices++ % primitive.offsets != primitive.vertex_offset) return;
    if (index >= positions_->size())
      scan_.fail("vertex index " + std::to_string(index) + " is out of range, there are " +
                 std::to_string(positions_->size()) + " vertices; repair the mesh");
    std::uint32_t& number = primitive.number[index];
    if (number == kNew) {
      number = static_cast<std::uint32_t>(part.vertices.size());
      part.vertices.push_back((*positions_)[index]);
    }
    corners.push_back(number);
  });
  check_indices(primitive, indices);
  return corners;
}

void ColladaGeometries::check_lists(const Primitive& primitive) const {
  const bool one = primitive.kind == "triangles" || primitive.kind == "polylist";
  const std::uint64_t expected = one ? std::min<std::uint64_t>(primitive.count, 1) : primitive.count;
  if ((one || primitive.kind == "polygons") && primitive.lists != expected)
    scan_.fail(std::to_string(primitive.lists) + " elements p, where the count of " + primitive.kind + " asks for " +
               std::to_string(expected) + "; repair the mesh");
}

// Of strips, fans and lines the count is not looked at: programs write wrong ones.
void ColladaGeometries::check_indices(const Primitive& primitive, std::uint64_t indices) const {
  const std::string& kind = primitive.kind;
  const auto expect = [&](std::uint64_t expected) {
    if (indices != expected)
      scan_.fail(std::to_string(indices) + " indices, where the count of " + kind + " asks for " +
                 std::to_string(expected) + "; repair the mesh");
  };
  if (kind == "triangles") return expect(3 * primitive.count * primitive.offsets);
  if (kind == "polylist") {
    if (primitive.sizes.size() != primitive.count)
      scan_.fail(std::to_string(primitive.sizes.size()) + " numbers in vcount for " + std::to_string(primitive.count) +
                 " polygons; repair the mesh");
    return expect(primitive.corners * primitive.offsets);
  }
  const std::uint64_t least = kind == "linestrips" ? 2 : kind == "tristrips" || kind == "trifans" ? 3 : 0;
  if (indices % primitive.offsets != 0 || indices / primitive.offsets < least || (indices > 0 && primitive.count == 0))
    scan_.fail(std::to_string(indices) + " indices do not fit " + kind + "; repair the mesh");
}

void ColladaGeometries::find_positions(const Primitive& primitive) {
  if (primitive.vertices != vertices_id_)
    scan_.fail("the input VERTEX names " + in_quotes(primitive.vertices) +
               ", which is no element vertices before it in the same mesh; repair the mesh");
  if (positions_) return;
  const auto found = accessors_.find(positions_source_);
  if (found == accessors_.end())
    scan_.fail("the positions " + in_quotes(positions_source_) + " are no source before them; repair the mesh");
  const Accessor& accessor = found->second;
  const auto [x, y, z] = accessor.place;
  const std::uint64_t width = std::max({x, y, z}) + 1;
  if ((accessor.params > 0 ? accessor.params : accessor.stride) < 3 || accessor.stride == 0 || x == y || y == z ||
      x == z)
    scan_.fail("the positions " + in_quotes(positions_source_) + " have no X, Y and Z; repair the mesh");
  const std::vector<double> numbers = numbers_of(accessor.array);
  const std::uint64_t count = accessor.count;
  if (count > 0 && accessor.offset + (count - 1) * accessor.stride +
                           std::max({accessor.params, width, accessor.offset == 0 ? accessor.stride : 0}) >
                       numbers.size())
    scan_.fail("the accessor of " + in_quotes("#" + accessor.array) + " reaches past its " +
               std::to_string(numbers.size()) + " values; repair the mesh");
  positions_.emplace();
  positions_->reserve(count);
  for (std::uint64_t n = 0; n < count; ++n) {
    const double* entry = numbers.data() + accessor.offset + n * accessor.stride;
    positions_->push_back({entry[x], entry[y], entry[z]});
  }
}

std::vector<double> ColladaGeometries::numbers_of(const std::string& id) const {
  const auto found = arrays_.find(id);
  if (found == arrays_.end()) scan_.fail("there is no float_array " + in_quotes(id) + " before; repair the mesh");
  const auto& [tag, count] = found->second;
  std::string_view rest = tag.kind == XmlTag::Kind::whole ? std::string_view() : tag.text;
  // Of a value and what parts it from the next.
  if (count > (rest.size() + 1) / 2)
    scan_.fail_at(tag, "an array of " + std::to_string(count) + " values in " + std::to_string(rest.size()) +
                           " characters; it is cut off or damaged, write the file again");
  std::vector<double> numbers;
  numbers.reserve(count);
  while (numbers.size() < count) {
    if (numbers.size() % 4096 == 0) file_.check();
    const std::string_view word = take_xml_word(rest);
    const auto number = double_in(word);
    if (!number)
      scan_.fail_at(tag, word.empty()
                             ? "an array of " + std::to_string(count) + " values holds " +
                                   std::to_string(numbers.size()) + "; repair the mesh"
                             : "element float_array must hold numbers, found " + in_quotes(word) + "; repair the mesh");
    numbers.push_back(*number);
  }
  return numbers;
}

template <class See>
void ColladaGeometries::each_whole(const XmlTag& tag, const See& see) const {
  if (tag.kind == XmlTag::Kind::whole) return;
  std::size_t steps = 0;
  std::string_view rest = tag.text;
  for (std::string_view word = take_xml_word(rest); !word.empty(); word = take_xml_word(rest)) {
    if (++steps % 4096 == 0) file_.check();
    const auto number = whole_in(word);
    if (!number)
      scan_.fail("element " + std::string(tag.name) + " must hold whole numbers from 0 on, found " +
                 in_quotes(word.substr(0, 20)) + "; repair the mesh");
    see(*number);
  }
  if (!tag.only_text) scan_.fail("element " + std::string(tag.name) + " must hold numbers only; repair the file");
}

std::uint64_t ColladaGeometries::whole(const XmlTag& tag, std::string_view attribute, std::uint64_t otherwise) const {
  std::string_view value = tag.attribute(attribute);
  if (value.empty()) return otherwise;
  const auto found = whole_in(take_xml_word(value));
  if (!found || !take_xml_word(value).empty())
    scan_.fail("attribute " + std::string(attribute) + " must be a whole number; repair the file");
  return *found;
}

}  // namespace standoff
