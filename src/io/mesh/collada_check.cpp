// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/collada_check.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/text_cursor.h"
#include "files/xml_scan.h"
#include "io/mesh/collada_nodes.h"

namespace standoff {
namespace {

constexpr int kDeepestElement = 500;  // elements; assimp calls itself for each
constexpr std::uint64_t kMostNumber = (std::uint64_t{1} << 31) - 1;
constexpr std::uint64_t kMostOffset = 255;  // inputs of a primitive; files have up to ten

// The whole number at the front of the text, which a space or the end must follow.
std::optional<std::uint64_t> take_number(std::string_view& text) {
  std::uint64_t number = 0;
  const char* end = text.data() + text.size();
  const auto [after, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || number > kMostNumber || (after != end && !is_space(*after))) return {};
  text.remove_prefix(static_cast<std::size_t>(after - text.data()));
  return number;
}

// Numbers as they stand in <p> and <vcount>.
struct Numbers {
  std::uint64_t count = 0, sum = 0;
};

class ColladaCheck {
 public:
  explicit ColladaCheck(const FileView& file) : scan_(file), nodes_(file, scan_, shapes_) {}

  void run() {
    XmlTag tag{};
    while (scan_.next(tag)) {
      check_depth(tag);
      shapes_.see(tag);
      nodes_.see(tag);
      see_library(tag);
      see_mesh(tag);
      see_primitive(tag);
      see_array(tag);
    }
    for (const Accessor& accessor : accessors_) check_accessor(accessor);
    nodes_.check();
  }

 private:
  struct Primitive {
    std::string_view kind;                            // nothing outside of one
    std::uint64_t count = 0, offsets = 1, lists = 0;  // lists: elements <p>
    bool has_vertices = false;
    Numbers corners;  // of <vcount>
  };
  struct Accessor {
    std::string_view source;
    std::uint64_t count = 0, stride = 1, offset = 0, params = 0;
  };

  void check_depth(const XmlTag& tag) {
    if (tag.kind == XmlTag::Kind::open && ++depth_ > kDeepestElement)
      scan_.fail("elements nested more than " + std::to_string(kDeepestElement) + " deep; flatten the scene");
    if (tag.kind == XmlTag::Kind::close) --depth_;
  }

  std::uint64_t number(const XmlTag& tag, std::string_view attribute, std::uint64_t otherwise) const {
    std::string_view value = tag.attribute(attribute);
    if (value.empty()) return otherwise;
    const auto found = take_number(value);
    if (!found || !value.empty())
      scan_.fail("attribute " + std::string(attribute) + " must be a whole number; repair the file");
    return *found;
  }

  Numbers numbers(const XmlTag& tag) const {
    if (tag.kind == XmlTag::Kind::whole) return {};
    Numbers found;
    std::string_view text = tag.text;
    for (skip_space(text); !text.empty(); skip_space(text)) {
      const std::string_view word = text.substr(0, 20);
      const auto value = take_number(text);
      if (!value)
        scan_.fail("element " + std::string(tag.name) + " must hold whole numbers from 0 on, found " +
                   in_quotes(word.substr(0, word.find_first_of(" \t\r\n"))) + "; repair the mesh");
      ++found.count;
      found.sum += *value;
    }
    if (!tag.only_text) scan_.fail("element " + std::string(tag.name) + " must hold numbers only; repair the file");
    return found;
  }

  // Assimp makes fourteen kilobytes of a material, and one of what else a library may hold.
  void see_library(const XmlTag& tag) {
    constexpr std::size_t kMostMaterials = 5000, kMostOthers = 50'000;
    constexpr std::string_view kOthers[] = {"effect",   "image",      "camera",   "light",
                                            "geometry", "controller", "animation"};
    if (tag.kind == XmlTag::Kind::close) return;
    if (tag.name == "material" && ++materials_ > kMostMaterials)
      scan_.fail("more than " + std::to_string(kMostMaterials) + " materials; write the file again without them");
    if (std::find(std::begin(kOthers), std::end(kOthers), tag.name) != std::end(kOthers) && ++others_ > kMostOthers)
      scan_.fail("more than " + std::to_string(kMostOthers) + " things in its libraries; split the file");
  }

  // Assimp adds a second mesh, or a second list of vertices, to the first one: corners then name the wrong vertices, or
  // none at all, which ends the program.
  void see_mesh(const XmlTag& tag) {
    if (tag.kind == XmlTag::Kind::close) return;
    if (tag.name == "geometry") meshes_ = 0;
    if (tag.name == "mesh") vertices_ = 0;
    if (tag.name == "mesh" && ++meshes_ > 1) scan_.fail("a second mesh in a geometry; give each a geometry of its own");
    if (tag.name == "vertices" && ++vertices_ > 1) scan_.fail("a second element vertices in a mesh; repair the mesh");
  }

  void see_primitive(const XmlTag& tag) {
    constexpr std::string_view kKinds[] = {"triangles", "polylist", "polygons",  "trifans",
                                           "tristrips", "lines",    "linestrips"};
    if (std::find(std::begin(kKinds), std::end(kKinds), tag.name) != std::end(kKinds)) {
      if (tag.kind != XmlTag::Kind::close) {
        if (!primitive_.kind.empty()) scan_.fail("a list of faces inside of another one; repair the file");
        primitive_.kind = tag.name;
        primitive_.count = number(tag, "count", 0);
        shapes_.add_part();
      }
      if (tag.kind != XmlTag::Kind::open) {
        check_lists();
        primitive_ = {};
      }
    }
    if (primitive_.kind.empty() || tag.kind == XmlTag::Kind::close) return;
    if (tag.name == "input") {
      const std::uint64_t offset = number(tag, "offset", 0);
      if (offset > kMostOffset) scan_.fail("an offset of " + std::to_string(offset) + "; repair the file");
      primitive_.offsets = std::max(primitive_.offsets, offset + 1);
      primitive_.has_vertices |= tag.attribute("semantic") == "VERTEX";
    } else if (tag.name == "vcount") {
      primitive_.corners = numbers(tag);
    } else if (tag.name == "p") {
      ++primitive_.lists;
      const std::uint64_t indices = numbers(tag).count;
      check_indices(indices);
      shapes_.add_corners(indices / primitive_.offsets);
    }
  }

  // Of strips and fans assimp takes as many as there are, of lines as many as their indices make.
  void check_lists() const {
    const auto& [kind, count, offsets, lists, has_vertices, corners] = primitive_;
    const bool one = kind == "triangles" || kind == "polylist";
    const std::uint64_t expected = one ? std::min<std::uint64_t>(count, 1) : count;
    if ((one || kind == "polygons") && lists != expected)
      scan_.fail(std::to_string(lists) + " elements p, where the count of " + std::string(kind) + " asks for " +
                 std::to_string(expected) + "; repair the mesh");
  }

  void check_indices(std::uint64_t indices) const {
    const auto& [kind, count, offsets, lists, has_vertices, corners] = primitive_;
    if (!has_vertices) scan_.fail("no input before the indices is called VERTEX; repair the file");
    const auto expect = [this, indices](std::uint64_t expected) {
      if (indices != expected)
        scan_.fail(std::to_string(indices) + " indices, where the count of " + std::string(primitive_.kind) +
                   " asks for " + std::to_string(expected) + "; repair the mesh");
    };
    if (kind == "triangles") return expect(3 * count * offsets);
    if (kind == "polylist") {
      if (corners.count != count)
        scan_.fail(std::to_string(corners.count) + " numbers in vcount for " + std::to_string(count) +
                   " polygons; repair the mesh");
      return expect(corners.sum * offsets);
    }
    // Assimp takes a fan for a polygon: another surface, unless it is flat and convex.
    if (kind == "trifans" && indices > 3 * offsets)
      scan_.fail("fans of more than three corners are not read; write triangles or tristrips");
    // Of a strip assimp takes one or two from the number of corners.
    const std::uint64_t least = kind == "linestrips" ? 2 : kind == "tristrips" ? 3 : 0;
    if (indices % offsets != 0 || indices / offsets < least || (indices > 0 && count == 0))
      scan_.fail(std::to_string(indices) + " indices do not fit " + std::string(kind) + "; repair the mesh");
  }

  void see_array(const XmlTag& tag) {
    if (tag.kind == XmlTag::Kind::close) return;
    if (tag.name.ends_with("_array")) {
      const std::uint64_t count = number(tag, "count", 0);
      // Of a value and what parts it from the next. Assimp asks for the memory of all first.
      if (count > (tag.text.size() + 1) / 2)
        scan_.fail("an array of " + std::to_string(count) + " values in " + std::to_string(tag.text.size()) +
                   " characters; it is cut off or damaged, write the file again");
      const auto [array, is_new] = arrays_.emplace(tag.attribute("id"), count);
      if (!is_new) array->second = std::min(array->second, count);
    } else if (tag.name == "accessor") {
      accessors_.push_back(
          {tag.attribute("source"), number(tag, "count", 0), number(tag, "stride", 1), number(tag, "offset", 0)});
    } else if (tag.name == "param" && !accessors_.empty()) {
      ++accessors_.back().params;
    }
  }

  void check_accessor(const Accessor& accessor) const {
    const auto& [source, count, stride, offset, params] = accessor;
    if (source.find('&') != source.npos) scan_.fail("the source of an accessor holds '&'; rename it");
    const auto array = arrays_.find(source.substr(std::min<std::size_t>(source.size(), 1)));
    if (array == arrays_.end() || count == 0) return;  // assimp looks for it, too
    const std::uint64_t width = std::max({params, std::uint64_t{1}, offset == 0 ? stride : 0});
    if (offset + (count - 1) * stride + width > array->second)
      scan_.fail("the accessor of " + in_quotes(source) + " reaches past its " + std::to_string(array->second) +
                 " values; repair the mesh");
  }

  XmlScan scan_;
  ColladaShapes shapes_;
  ColladaNodes nodes_;
  int depth_ = 0;
  std::size_t materials_ = 0, others_ = 0;
  int meshes_ = 0, vertices_ = 0;  // of the geometry and of the mesh around the tag
  Primitive primitive_;
  std::map<std::string_view, std::uint64_t> arrays_;
  std::vector<Accessor> accessors_;
};

}  // namespace

void check_collada(const FileView& file) { ColladaCheck(file).run(); }

}  // namespace standoff
