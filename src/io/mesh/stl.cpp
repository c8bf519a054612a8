// SPDX-License-Identifier: Apache-2.0
// STL, binary and ASCII: triangles as three corners each, welded here. Binary: 80 bytes of free text, a 32-bit count,
// then 50 bytes a triangle.
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>

#include "core/weld.h"
#include "files/text.h"
#include "io/mesh/builder.h"
#include "io/mesh/format.h"
#include "io/mesh/writers.h"

namespace standoff {
namespace {

/// 80 bytes of free text, a 32-bit count, then 50 bytes per triangle: normal and three corners as 32-bit floats, and
/// two bytes that mean nothing here. Little endian.
inline constexpr std::size_t kStlHeader = 84;
inline constexpr std::size_t kStlRecord = 50;
inline constexpr std::size_t kStlCount = 80;
inline constexpr std::size_t kStlCorners = 12;  ///< in a record

inline std::uint64_t stl_binary_size(std::uint32_t triangles) {
  return kStlHeader + std::uint64_t{kStlRecord} * triangles;
}

/// The count of triangles in the header. Requires content.size() >= kStlHeader.
inline std::uint32_t stl_count(std::string_view content) {
  std::uint32_t count;
  std::memcpy(&count, content.data() + kStlCount, sizeof count);
  return count;
}

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

bool is_stl(std::string_view content) {
  return is_ascii(content) || (content.size() >= kStlHeader && content.size() == stl_binary_size(stl_count(content)));
}

Mesh read_stl(const FileView& file) { return is_ascii(file.bytes()) ? read_ascii(file) : read_binary(file); }

Vec3 unit_normal(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 n = cross(b - a, c - a);
  const double size = length(n);
  return std::isnormal(size) ? n * (1 / size) : Vec3{};
}

void write_stl(AtomicFile& file, MeshView mesh) {
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max())
    fail_to_write(file, "STL holds at most 4294967295 triangles; write .ply");
  std::array<char, kStlHeader> header{};
  constexpr std::string_view kText = "standoff, binary STL, little endian";
  kText.copy(header.data(), kText.size());
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  std::memcpy(header.data() + kStlCount, &count, sizeof count);
  file.write(header.data(), header.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    for (const Vec3& corner : {a, b, c}) check_fits_floats(file, corner, "STL");
    std::array<char, kStlRecord> record{};
    char* at = record.data();
    for (const auto& floats : {as_floats(unit_normal(a, b, c)), as_floats(a), as_floats(b), as_floats(c)}) {
      std::memcpy(at, floats.data(), sizeof floats);
      at += sizeof floats;
    }
    file.write(record.data(), record.size());
  }
}

}  // namespace

constinit const MeshFormat kMeshStl{"stl",  "STL",           "STL, binary or ASCII; written as binary",
                                    is_stl, as_is<read_stl>, as_they_are<write_stl>,
                                    false,  Axis::z};

}  // namespace standoff
