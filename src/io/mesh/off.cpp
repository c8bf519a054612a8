// SPDX-License-Identifier: Apache-2.0
// OFF, the Object File Format in text: counts, one vertex per line, one face per line.
#include <cctype>
#include <vector>

#include "files/text.h"
#include "io/mesh/builder.h"
#include "io/mesh/format.h"

namespace standoff {
namespace {

// The length of the keyword at the beginning, or 0. The letters before OFF promise texture coordinates, colours and
// normals after the coordinates of each vertex. In a well-known collection the counts follow without a space.
std::size_t keyword_length(std::string_view content) {
  std::size_t at = 0;
  for (const std::string_view letters : {"ST", "C", "N"})
    if (content.substr(at).starts_with(letters)) at += letters.size();
  if (!content.substr(at).starts_with("OFF")) return 0;
  at += 3;
  const bool ends =
      at == content.size() || is_space(content[at]) || std::isdigit(static_cast<unsigned char>(content[at]));
  return ends ? at : 0;
}

class OffReader {
 public:
  explicit OffReader(const FileView& file) : text_(file, keyword_length(file.bytes())), builder_(file) {}

  Mesh read() {
    if (text_.offset() == 0) text_.fail("an OFF file in three dimensions starts with OFF; check that it is one");
    next_line();
    const std::uint64_t vertices = count("vertices"), faces = count("faces");
    // "0 0 0" and a line end is the least a vertex can take, "0" that of a face.
    if (vertices > text_.left() / 6 || faces > (text_.left() + 1) / 2)
      text_.fail("it promises " + std::to_string(vertices) + " vertices and " + std::to_string(faces) +
                 " faces, more than the file can hold; it is cut off or damaged, get all of it");
    text_.skip_line();
    read_vertices(vertices);
    read_faces(faces);
    return builder_.finish([](std::size_t v) { return "vertex " + std::to_string(v); });
  }

 private:
  // To the next line that says something.
  void next_line() {
    for (text_.skip_space(); !text_.at_end() && *text_.position() == '#'; text_.skip_space()) text_.skip_line();
  }

  template <class Number>
  Number number() {
    text_.skip_blanks();
    return text_.number<Number>();
  }

  std::uint64_t count(const char* what) {
    const auto n = number<std::int64_t>();
    if (n < 0) text_.fail("a negative count of " + std::string(what) + "; the file is damaged, write it again");
    return static_cast<std::uint64_t>(n);
  }

  void next_row(const char* what, std::uint64_t row, std::uint64_t rows) {
    next_line();
    if (text_.at_end())
      text_.fail("the file ends where " + std::string(what) + " " + std::to_string(row) + " of " +
                 std::to_string(rows) + " should stand; it is cut off, get all of it");
  }

  void read_vertices(std::uint64_t vertices) {
    builder_.vertices.reserve(vertices);
    for (std::uint64_t v = 0; v < vertices; ++v) {
      next_row("vertex", v, vertices);
      const double x = number<double>(), y = number<double>(), z = number<double>();
      builder_.vertices.push_back({x, y, z});
      text_.skip_line();
    }
  }

  void read_faces(std::uint64_t faces) {
    builder_.triangles.reserve(faces);
    std::vector<std::uint32_t> corners;
    for (std::uint64_t f = 0; f < faces; ++f) {
      next_row("face", f, faces);
      corners.clear();
      for (auto left = number<std::int64_t>(); left > 0; --left) corners.push_back(index());
      builder_.add_face(corners);
      text_.skip_line();
    }
  }

  std::uint32_t index() {
    const auto i = number<std::int64_t>();
    if (i < 0 || static_cast<std::uint64_t>(i) >= builder_.vertices.size())
      text_.fail("vertex index " + std::to_string(i) + " is out of range, there are " +
                 std::to_string(builder_.vertices.size()) + " vertices; repair the mesh");
    return static_cast<std::uint32_t>(i);
  }

  TextCursor text_;
  MeshBuilder builder_;
};

bool is_off(std::string_view content) { return keyword_length(content) > 0; }

Mesh read_off(const FileView& file) { return OffReader(file).read(); }

}  // namespace

constinit const MeshFormat kMeshOff{"off", "OFF", "OFF, text", is_off, as_is<read_off>};

}  // namespace standoff
