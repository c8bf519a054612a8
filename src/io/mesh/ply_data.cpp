// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/ply_data.h"

#include <array>
#include <utility>

#include "files/text.h"
#include "io/mesh/format.h"

namespace standoff {
namespace {

// Each type goes by two names.
constexpr std::array<std::pair<const char*, StoredType>, 16> kTypes{{{"char", StoredType::int8},
                                                                     {"int8", StoredType::int8},
                                                                     {"uchar", StoredType::uint8},
                                                                     {"uint8", StoredType::uint8},
                                                                     {"short", StoredType::int16},
                                                                     {"int16", StoredType::int16},
                                                                     {"ushort", StoredType::uint16},
                                                                     {"uint16", StoredType::uint16},
                                                                     {"int", StoredType::int32},
                                                                     {"int32", StoredType::int32},
                                                                     {"uint", StoredType::uint32},
                                                                     {"uint32", StoredType::uint32},
                                                                     {"float", StoredType::float32},
                                                                     {"float32", StoredType::float32},
                                                                     {"double", StoredType::float64},
                                                                     {"float64", StoredType::float64}}};

constexpr std::size_t kMostElements = 1000;  // elements; files have up to ten

class HeaderReader {
 public:
  explicit HeaderReader(const FileView& file) : text_(file) {}

  PlyHeader read() {
    if (word() != "ply") text_.fail("a PLY file starts with a line that says ply; check that it is one");
    const char* line_end = text_.position();
    text_.skip_line();
    // In this order: where the file ends with its first word, there is no byte to look at.
    const bool lone_cr = text_.position() == line_end + 1 && *line_end == '\r';
    while (read_line()) {
    }
    if (!format_known_) text_.fail("the header has no format line; add one, such as format ascii 1.0");
    // The body of a binary file may begin with the byte that ends lines: take no more than this file's line ends.
    text_.skip_blanks();
    if (lone_cr)
      text_.take('\r');
    else
      text_.skip_line();
    header_.body = text_.offset();
    return std::move(header_);
  }

 private:
  std::string_view word() {
    text_.skip_blanks();
    return text_.word();
  }

  // False after end_header, whose line end is still to be taken.
  bool read_line() {
    const std::string_view keyword = word();
    if (keyword == "end_header") return false;
    if (keyword == "format")
      read_format();
    else if (keyword == "element")
      read_element();
    else if (keyword == "property")
      read_property();
    else if (text_.at_end())
      text_.fail("the file ends in the header; it is cut off, get all of it");
    else if (!keyword.empty() && !is_comment(keyword))
      text_.fail_at(keyword.data(),
                    "unknown header keyword " + in_quotes(keyword) + "; the header is damaged, write the file again");
    text_.skip_line();
    return true;
  }

  // Blender 2.4 wrote its comment, "Created by Blender", without the word for it.
  static bool is_comment(std::string_view keyword) {
    return keyword == "comment" || keyword == "obj_info" || keyword == "Created";
  }

  void read_format() {
    const std::string_view name = word();
    if (name == "ascii")
      header_.encoding = PlyHeader::Encoding::ascii;
    else if (name == "binary_little_endian")
      header_.encoding = PlyHeader::Encoding::little_endian;
    else if (name == "binary_big_endian")
      header_.encoding = PlyHeader::Encoding::big_endian;
    else
      text_.fail("unknown format " + in_quotes(name) +
                 "; write it as ascii, binary_little_endian or binary_big_endian");
    format_known_ = true;
  }

  void read_element() {
    PlyElement element;
    element.name = word();
    text_.skip_blanks();
    const auto count = text_.number<std::int64_t>();
    if (element.name.empty() || count < 0)
      text_.fail("an element needs a name and a count; the header is damaged, write the file again");
    element.count = static_cast<std::uint64_t>(count);
    // Every element is compared with those before it, and every property walked for every row.
    if (header_.elements.size() == kMostElements)
      text_.fail("more than 1000 elements in the header; it is damaged, write the file again");
    for (const PlyElement& other : header_.elements)
      if (other.name == element.name) text_.fail("two elements called " + in_quotes(element.name) + "; remove one");
    header_.elements.push_back(std::move(element));
  }

  void read_property() {
    if (header_.elements.empty())
      text_.fail("a property before the first element; the header is damaged, write the file again");
    PlyProperty property;
    std::string_view type_name = word();
    property.list = type_name == "list";
    if (property.list) {
      property.count_type = type(word());
      if (property.count_type >= StoredType::float32)
        text_.fail("the count of a list must be an integer; the header is damaged, write the file again");
      type_name = word();
    }
    property.type = type(type_name);
    property.name = word();
    if (property.name.empty()) text_.fail("a property without a name; the header is damaged, write the file again");
    header_.elements.back().properties.push_back(std::move(property));
  }

  StoredType type(std::string_view name) const {
    for (const auto& [known, type] : kTypes)
      if (name == known) return type;
    text_.fail("unknown type " + in_quotes(name) +
               "; write the file again with char, uchar, short, ushort, int, uint, float or double");
  }

  TextCursor text_;
  PlyHeader header_;
  bool format_known_ = false;
};

}  // namespace

std::size_t ply_size(StoredType type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

int PlyElement::find(const char* property) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property) return static_cast<int>(i);
  return -1;
}

// In text a value takes a digit and a space; the last space of the file may be missing.
std::uint64_t PlyElement::least_bytes(bool ascii) const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& p : properties) bytes += ascii ? 2 : ply_size(p.list ? p.count_type : p.type);
  return bytes;
}

std::array<int, 3> position_axes(const FileView& file, const PlyElement& vertices) {
  const std::array<int, 3> axes{vertices.find("x"), vertices.find("y"), vertices.find("z")};
  for (const int axis : axes)
    if (axis < 0 || vertices.properties[static_cast<std::size_t>(axis)].list)
      file.fail("header", "element vertex needs properties x, y and z; write the file again with them");
  return axes;
}

bool is_ply(std::string_view content) {
  return content.starts_with("ply") && content.size() > 3 && is_space(content[3]);
}

PlyHeader read_ply_header(const FileView& file) { return HeaderReader(file).read(); }

}  // namespace standoff
