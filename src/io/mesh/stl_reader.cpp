// SPDX-License-Identifier: Apache-2.0
// STL, binary and ASCII: triangles as three corners each, welded here.
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <bit>

#include "core/weld.h"
#include "files/text_cursor.h"
#include "io/mesh/builder.h"
#include "io/mesh/format.h"
#include "io/mesh/stl_binary.h"
#include "standoff/error.h"

namespace standoff {
namespace {

static_assert(std::endian::native == std::endian::little);

bool starts_solid(std::string_view content) {
  const auto first = std::find_if_not(content.begin(), content.end(), is_space);
  const auto word = content.substr(static_cast<std::size_t>(first - content.begin()), 5);
  return equals_ignoring_case(word, "solid");
}

// Many programs write binary files that begin with "solid": the size decides first, then whether the beginning is text.
// A binary one holds a zero byte there, if not in its name then in its count or first numbers.
bool is_ascii(std::string_view content) {
  if (!starts_solid(content)) return false;
  if (content.size() >= kStlHeader && content.size() == stl_binary_size(stl_count(content))) return false;
  constexpr std::size_t kEnough = 512;
  return content.substr(0, kEnough).find('\0') == content.npos;
}

Vec3 stored_corner(const char* records, std::uint32_t corner) {
  std::array<float, 3> c;
  std::memcpy(c.data(), records + std::uint64_t{corner / 3} * kStlRecord + kStlCorners + corner % 3 * sizeof c,
              sizeof c);
  return {c[0], c[1], c[2]};
}

// The mesh of the triangles whose corners are position(0), position(1), ...
template <class Position>
Mesh welded(const FileView& file, std::size_t triangles, const Position& position) {
  Mesh mesh;
  mesh.triangles.resize(triangles);
  const std::span number(mesh.triangles.data()->data(), 3 * triangles);
  mesh.vertices.reserve(weld(position, number, [&] { file.check(); }));
  for (std::uint32_t i = 0; i < number.size(); ++i)
    if (number[i] == mesh.vertices.size()) mesh.vertices.push_back(position(i) + kPositiveZero);
  return mesh;
}

// The first corner that is not finite, or `corners`.
template <class Position>
std::uint32_t first_not_finite(std::uint32_t corners, const Position& position) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::uint32_t>(0, corners, 1 << 14), corners,
      [&](const auto& range, std::uint32_t found) {
        for (std::uint32_t i = range.begin(); i < range.end() && i < found; ++i)
          if (!is_finite(position(i))) return i;
        return found;
      },
      [](std::uint32_t a, std::uint32_t b) { return std::min(a, b); });
}

Mesh read_binary(const FileView& file) {
  if (file.size() < kStlHeader)
    file.fail("byte " + std::to_string(file.size()),
              "neither ASCII STL nor long enough for the header of a binary one; check that it is an STL file");
  const std::uint32_t count = stl_count(file.bytes());
  if (count == 0) fail_no_triangles(file);
  if (file.size() < stl_binary_size(count)) {
    const std::size_t complete = (file.size() - kStlHeader) / kStlRecord;
    file.fail("triangle " + std::to_string(complete),
              "the file ends here, its header promises " + std::to_string(count) +
                  " triangles; it is cut off, get all of it, or check that it is an STL file");
  }
  check_counts(file, std::uint64_t{3} * count, count);
  const char* records = file.bytes().data() + kStlHeader;
  const auto position = [=](std::uint32_t corner) { return stored_corner(records, corner); };
  const std::uint32_t bad = first_not_finite(3 * count, position);
  if (bad != 3 * count) file.fail("triangle " + std::to_string(bad / 3), kNotFinite);
  return welded(file, count, position);
}

class AsciiStl {
 public:
  explicit AsciiStl(const FileView& file) : text_(file) {}

  std::vector<Vec3> corners() {
    expect("solid");
    text_.skip_line();
    bool inside = true;
    for (;;) {
      const std::string_view word = text_.next_word();
      if (inside && equals_ignoring_case(word, "facet")) {
        facet();
      } else if (inside && equals_ignoring_case(word, "endsolid")) {
        text_.skip_line();
        inside = false;
      } else if (!inside && equals_ignoring_case(word, "solid")) {
        text_.skip_line();
        inside = true;
      } else if (!inside && word.empty()) {
        return std::move(corners_);
      } else {
        fail(word, inside ? "facet or endsolid" : "solid or the end of the file");
      }
    }
  }

 private:
  void facet() {
    expect("normal");
    // Whatever it says: some programs write "nan" here, and nobody needs it.
    for (int i = 0; i < 3; ++i) text_.next_word();
    expect("outer");
    expect("loop");
    for (int i = 0; i < 3; ++i) {
      expect("vertex");
      const char* place = text_.position();
      const double x = number(), y = number(), z = number();
      corners_.push_back({x, y, z});
      if (!is_finite(corners_.back())) text_.fail_at(place, kNotFinite);
    }
    expect("endloop");
    expect("endfacet");
  }

  double number() {
    text_.skip_space();
    return text_.number<double>();
  }

  void expect(const char* wanted) {
    const std::string_view word = text_.next_word();
    if (!equals_ignoring_case(word, wanted)) fail(word, wanted);
  }

  [[noreturn]] void fail(std::string_view word, const std::string& wanted) const {
    if (word.empty()) text_.fail("the file ends where " + wanted + " should stand; it is cut off, get all of it");
    text_.fail_at(word.data(),
                  "expected " + wanted + ", found " + in_quotes(word) + "; the file is damaged, write it again");
  }

  TextCursor text_;
  std::vector<Vec3> corners_;
};

Mesh read_ascii(const FileView& file) {
  const std::vector<Vec3> corners = AsciiStl(file).corners();
  if (corners.empty()) fail_no_triangles(file);
  check_counts(file, corners.size(), corners.size() / 3);
  return welded(file, corners.size() / 3, [&](std::uint32_t i) { return corners[i]; });
}

}  // namespace

bool is_stl(std::string_view content) {
  return is_ascii(content) || (content.size() >= kStlHeader && content.size() == stl_binary_size(stl_count(content)));
}

Mesh read_stl(const FileView& file) { return is_ascii(file.bytes()) ? read_ascii(file) : read_binary(file); }

}  // namespace standoff
