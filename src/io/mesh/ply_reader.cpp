// SPDX-License-Identifier: Apache-2.0
// The body of PLY files: any properties in any order; only positions and faces are kept.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <type_traits>

#include "files/text_cursor.h"
#include "io/mesh/builder.h"
#include "io/mesh/format.h"
#include "io/mesh/ply_header.h"

namespace standoff {
namespace {

static_assert(std::endian::native == std::endian::little);

// Which row is being read, for messages.
struct Row {
  const FileView& file;
  const PlyElement* element = nullptr;
  std::uint64_t number = 0;

  [[noreturn]] void fail(const std::string& message) const {
    file.fail(shown(element->name) + " " + std::to_string(number), message);
  }
};

/// Calls body with a value of the C++ type.
template <class Body>
decltype(auto) with_type(PlyType type, const Body& body) {
  switch (type) {
    case PlyType::int8:
      return body(std::int8_t{});
    case PlyType::uint8:
      return body(std::uint8_t{});
    case PlyType::int16:
      return body(std::int16_t{});
    case PlyType::uint16:
      return body(std::uint16_t{});
    case PlyType::int32:
      return body(std::int32_t{});
    case PlyType::uint32:
      return body(std::uint32_t{});
    case PlyType::float32:
      return body(float{});
    case PlyType::float64:
      break;
  }
  return body(double{});
}

template <bool kBigEndian>
class BinaryBody {
 public:
  static constexpr bool kAscii = false;
  BinaryBody(const FileView& file, const PlyHeader& header, const Row& row)
      : rest_(file.bytes().substr(header.body)), row_(row) {}

  std::uint64_t bytes_left() const { return rest_.size(); }

  template <class Number>
  Number value(PlyType type) {
    return with_type(type, [&](auto stored) {
      require(sizeof stored);
      std::array<char, sizeof stored> bytes;
      std::memcpy(bytes.data(), rest_.data(), sizeof stored);
      if constexpr (kBigEndian) std::reverse(bytes.begin(), bytes.end());
      rest_.remove_prefix(sizeof stored);
      return static_cast<Number>(std::bit_cast<decltype(stored)>(bytes));
    });
  }

  void skip(PlyType type, std::uint64_t count) {
    // A count is a 32-bit number: no overflow.
    require(count * ply_size(type));
    rest_.remove_prefix(count * ply_size(type));
  }

  void end_row() {}

 private:
  void require(std::uint64_t bytes) const {
    if (rest_.size() < bytes)
      row_.fail("the file ends here, of " + std::to_string(row_.element->count) + "; it is cut off, get all of it");
  }

  std::string_view rest_;
  const Row& row_;
};

// A row has a line of its own, and what follows its values there is not looked at: some programs add to a row without
// a word in the header. Others break rows into several lines, or put all into one. So values are taken wherever they
// are, and the rest of a row's last line is passed over where there are lines enough for all rows.
class AsciiBody {
 public:
  static constexpr bool kAscii = true;
  AsciiBody(const FileView& file, const PlyHeader& header, const Row&)
      : file_(file), header_(header), text_(file, header.body) {}

  std::uint64_t bytes_left() const { return file_.size() - text_.offset(); }

  // A value declared as float is one, so that a file reads the same in text and in binary.
  template <class Number>
  Number value(PlyType type) {
    text_.skip_space();
    if (type < PlyType::float32) return static_cast<Number>(text_.number<std::int64_t>());
    return static_cast<Number>(type == PlyType::float32 ? text_.number<float>() : text_.number<double>());
  }

  void skip(PlyType, std::uint64_t count) {
    while (count-- > 0)
      if (text_.next_word().empty())
        text_.fail("the file ends in the middle of its data; it is cut off, get all of it");
  }

  void end_row() {
    text_.skip_blanks();
    if (text_.at_line_end()) return;
    if (!lines_are_rows_) lines_are_rows_ = count_lines() >= count_rows();
    if (*lines_are_rows_) text_.skip_line();
  }

 private:
  std::uint64_t count_rows() const {
    double rows = 0;  // files can ask for more than 64 bits count
    for (const PlyElement& element : header_.elements)
      if (!element.properties.empty()) rows += static_cast<double>(element.count);
    return static_cast<std::uint64_t>(std::min(rows, 0x1p63));
  }
  std::uint64_t count_lines() const {
    std::uint64_t lines = 0;
    TextCursor text(file_, header_.body);
    for (text.skip_space(); !text.at_end(); text.skip_space(), ++lines) text.skip_line();
    return lines;
  }

  const FileView& file_;
  const PlyHeader& header_;
  TextCursor text_;
  std::optional<bool> lines_are_rows_;  // asked where a row has more than its values
};

template <class Body>
class PlyReader {
 public:
  PlyReader(const FileView& file, const PlyHeader& header)
      : file_(file), header_(header), row_{file}, body_(file, header, row_), builder_(file) {}

  Mesh read() {
    for (const PlyElement& element : header_.elements)
      if (element.name == "vertex") vertex_count_ = element.count;
    for (const PlyElement& element : header_.elements) read_element(element);
    return builder_.finish([](std::size_t v) { return "vertex " + std::to_string(v); });
  }

 private:
  void read_element(const PlyElement& element) {
    row_.element = &element;
    row_.number = 0;
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face",
               is_strips = element.name == "tristrips";
    const std::uint64_t least = element.least_bytes(Body::kAscii);
    // Rows without content need no loop, however many the header claims. Vertices and faces without any are refused
    // below.
    if (least == 0 && !is_vertex && !is_face && !is_strips) return;
    if (least > 0 && element.count > (body_.bytes_left() + Body::kAscii) / least)
      file_.fail("header", "it promises " + std::to_string(element.count) + " of element " + in_quotes(element.name) +
                               ", more than the file can hold; it is cut off or damaged, get all of it");
    if (is_vertex)
      read_vertices(element);
    else if (is_face)
      read_faces(element);
    else if (is_strips)
      read_strips(element);
    else
      for_each_row(element, [&](const PlyProperty& property) { skip(property); });
  }

  template <class ReadProperty>
  void for_each_row(const PlyElement& element, const ReadProperty& read_property) {
    for (row_.number = 0; row_.number < element.count; ++row_.number) {
      for (const PlyProperty& property : element.properties) read_property(property);
      body_.end_row();
    }
  }

  void skip(const PlyProperty& property) { body_.skip(property.type, property.list ? list_length(property) : 1); }

  std::uint64_t list_length(const PlyProperty& property) {
    const auto length = body_.template value<std::int64_t>(property.count_type);
    if (length < 0) row_.fail("a list of " + std::to_string(length) + " values; the file is damaged, write it again");
    if (static_cast<std::uint64_t>(length) > body_.bytes_left())
      row_.fail("a list of " + std::to_string(length) +
                " values, more than the file can hold; it is cut off or damaged, get all of it");
    return static_cast<std::uint64_t>(length);
  }

  void read_vertices(const PlyElement& element) {
    std::array<int, 3> axis{element.find("x"), element.find("y"), element.find("z")};
    for (const int found : axis)
      if (found < 0 || element.properties[static_cast<std::size_t>(found)].list)
        file_.fail("header", "element vertex needs properties x, y and z; write the file again with them");
    builder_.vertices.resize(element.count);
    for (row_.number = 0; row_.number < element.count; ++row_.number) {
      Vec3& vertex = builder_.vertices[row_.number];
      for (int p = 0; const PlyProperty& property : element.properties) {
        if (p == axis[0])
          vertex.x = body_.template value<double>(property.type);
        else if (p == axis[1])
          vertex.y = body_.template value<double>(property.type);
        else if (p == axis[2])
          vertex.z = body_.template value<double>(property.type);
        else
          skip(property);
        ++p;
      }
      body_.end_row();
    }
  }

  // The list of vertices of each row of an element.
  const PlyProperty& corners_of(const PlyElement& element) const {
    int corners = element.find("vertex_indices");
    if (corners < 0) corners = element.find("vertex_index");
    const PlyProperty* list = corners < 0 ? nullptr : &element.properties[static_cast<std::size_t>(corners)];
    if (!list || !list->list || list->type >= PlyType::float32)
      file_.fail("header", "element " + element.name +
                               " needs a list of integers called vertex_indices; write the file again with one");
    return *list;
  }

  void read_faces(const PlyElement& element) {
    const PlyProperty& list = corners_of(element);
    builder_.triangles.reserve(element.count);
    std::vector<std::uint32_t> face;
    for_each_row(element, [&](const PlyProperty& property) {
      if (&property != &list) return skip(property);
      face.resize(list_length(property));
      for (auto& corner : face) corner = index(body_.template value<std::int64_t>(property.type));
      builder_.add_face(face);
    });
  }

  // Strips of triangles, as scans of Stanford's have them: all in one list, with -1 between one and the next. Every
  // other triangle of a strip turns the other way round, and is turned back here.
  void read_strips(const PlyElement& element) {
    const PlyProperty& list = corners_of(element);
    for_each_row(element, [&](const PlyProperty& property) {
      if (&property != &list) return skip(property);
      std::array<std::uint32_t, 2> before{};
      std::uint64_t corners = 0;  // of this strip, so far
      for (std::uint64_t left = list_length(property); left > 0; --left) {
        const auto value = body_.template value<std::int64_t>(property.type);
        if (value == -1) {
          corners = 0;
          continue;
        }
        const std::uint32_t corner = index(value);
        if (++corners > 2)
          builder_.triangles.push_back(corners % 2 == 1 ? Triangle{before[0], before[1], corner}
                                                        : Triangle{before[1], before[0], corner});
        before = {before[1], corner};
      }
    });
  }

  std::uint32_t index(std::int64_t value) {
    if (value < 0 || static_cast<std::uint64_t>(value) >= vertex_count_)
      row_.fail("vertex index " + std::to_string(value) + " is out of range, there are " +
                std::to_string(vertex_count_) + " vertices; repair the mesh");
    return static_cast<std::uint32_t>(value);
  }

  const FileView& file_;
  const PlyHeader& header_;
  Row row_;
  Body body_;
  MeshBuilder builder_;
  std::uint64_t vertex_count_ = 0;
};

}  // namespace

Mesh read_ply(const FileView& file) {
  const PlyHeader header = read_ply_header(file);
  switch (header.encoding) {
    case PlyHeader::Encoding::little_endian:
      return PlyReader<BinaryBody<false>>(file, header).read();
    case PlyHeader::Encoding::big_endian:
      return PlyReader<BinaryBody<true>>(file, header).read();
    case PlyHeader::Encoding::ascii:
      break;
  }
  return PlyReader<AsciiBody>(file, header).read();
}

}  // namespace standoff
