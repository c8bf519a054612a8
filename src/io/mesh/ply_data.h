// SPDX-License-Identifier: Apache-2.0
// What a PLY file holds: the header, which says the order and types of the values, and the body, ASCII or binary.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "files/file_view.h"
#include "files/text.h"
#include "io/mesh/stored_type.h"
#include "standoff/vec.h"

namespace standoff {

/// Bytes of a value in a binary body.
std::size_t ply_size(StoredType type);

struct PlyProperty {
  std::string name;
  StoredType type;
  bool list = false;
  StoredType count_type = StoredType::uint8;  ///< lists only; an integer
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// The property of that name, or -1.
  int find(const char* property) const;
  /// The least bytes that one row can take in the body.
  std::uint64_t least_bytes(bool ascii) const;
};

struct PlyHeader {
  enum class Encoding { ascii, little_endian, big_endian };
  Encoding encoding = Encoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t body = 0;  ///< offset of the first byte after the header
};

/// Which properties of the vertices are x, y and z. Errors: input, if one is missing or a list.
std::array<int, 3> position_axes(const FileView& file, const PlyElement& vertices);

/// Errors: input, with the line.
PlyHeader read_ply_header(const FileView& file);

static_assert(std::endian::native == std::endian::little);

/// Which row is being read, for messages.
struct PlyRow {
  const FileView& file;
  const PlyElement* element = nullptr;
  std::uint64_t number = 0;

  [[noreturn]] void fail(const std::string& message) const {
    file.fail(shown(element->name) + " " + std::to_string(number), message);
  }
};

/// The two kinds of binary.
template <bool kBigEndian>
class PlyBinaryBody {
 public:
  static constexpr bool kAscii = false;
  PlyBinaryBody(const FileView& file, const PlyHeader& header, const PlyRow& row)
      : rest_(file.bytes().substr(header.body)), row_(row) {}

  std::uint64_t bytes_left() const { return rest_.size(); }

  template <class Number>
  Number value(StoredType type) {
    return with_type(type, [&](auto stored) {
      require(sizeof stored);
      std::array<char, sizeof stored> bytes;
      std::memcpy(bytes.data(), rest_.data(), sizeof stored);
      if constexpr (kBigEndian) std::reverse(bytes.begin(), bytes.end());
      rest_.remove_prefix(sizeof stored);
      return static_cast<Number>(std::bit_cast<decltype(stored)>(bytes));
    });
  }

  void skip(StoredType type, std::uint64_t count) {
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
  const PlyRow& row_;
};

/// A row has a line of its own, and what follows its values there is not looked at: some programs add to a row without
/// a word in the header. Others break rows into several lines, or put all into one. So values are taken wherever they
/// are, and the rest of a row's last line is passed over where there are lines enough for all rows.
class PlyAsciiBody {
 public:
  static constexpr bool kAscii = true;
  PlyAsciiBody(const FileView& file, const PlyHeader& header, const PlyRow&)
      : file_(file), header_(header), text_(file, header.body) {}

  std::uint64_t bytes_left() const { return file_.size() - text_.offset(); }

  // A value declared as float is one, so that a file reads the same in text and in binary.
  template <class Number>
  Number value(StoredType type) {
    text_.skip_space();
    if (type < StoredType::float32) return static_cast<Number>(text_.number<std::int64_t>());
    return static_cast<Number>(type == StoredType::float32 ? text_.number<float>() : text_.number<double>());
  }

  void skip(StoredType, std::uint64_t count) {
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

/// Throws Error{input} where the header promises more rows than the file can hold.
template <class Body>
void check_count(const FileView& file, const PlyElement& element, const Body& body) {
  const std::uint64_t least = element.least_bytes(Body::kAscii);
  if (least > 0 && element.count > (body.bytes_left() + Body::kAscii) / least)
    file.fail("header", "it promises " + std::to_string(element.count) + " of element " + in_quotes(element.name) +
                            ", more than the file can hold; it is cut off or damaged, get all of it");
}

/// The number of values of a list, which are no more than the file has bytes left.
template <class Body>
std::uint64_t list_length(Body& body, const PlyRow& row, const PlyProperty& property) {
  const auto length = body.template value<std::int64_t>(property.count_type);
  if (length < 0) row.fail("a list of " + std::to_string(length) + " values; the file is damaged, write it again");
  if (static_cast<std::uint64_t>(length) > body.bytes_left())
    row.fail("a list of " + std::to_string(length) +
             " values, more than the file can hold; it is cut off or damaged, get all of it");
  return static_cast<std::uint64_t>(length);
}

template <class Body>
void skip_property(Body& body, const PlyRow& row, const PlyProperty& property) {
  body.skip(property.type, property.list ? list_length(body, row, property) : 1);
}

/// The next row's position, and into `number` its property `beside`, if that is not below 0; all else is passed over.
template <class Body>
Vec3 read_position(Body& body, const PlyRow& row, const std::array<int, 3>& axes, int beside = -1,
                   double* number = nullptr) {
  Vec3 position;
  for (int p = 0; const PlyProperty& property : row.element->properties) {
    if (p == axes[0])
      position.x = body.template value<double>(property.type);
    else if (p == axes[1])
      position.y = body.template value<double>(property.type);
    else if (p == axes[2])
      position.z = body.template value<double>(property.type);
    else if (p == beside)
      *number = body.template value<double>(property.type);
    else
      skip_property(body, row, property);
    ++p;
  }
  body.end_row();
  return position;
}

/// Whether the content is PLY.
bool is_ply(std::string_view content);

}  // namespace standoff
