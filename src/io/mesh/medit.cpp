// SPDX-License-Identifier: Apache-2.0
// Medit's .mesh in text (INRIA, report RT-0253): keywords, each with a count and as many rows. Triangles and
// quadrilaterals are read, everything else is passed over.
#include <cctype>
#include <string>
#include <vector>

#include "files/text.h"
#include "io/mesh/builder.h"
#include "io/mesh/format.h"

namespace standoff {
namespace {

constexpr std::string_view kFirstWord = "MeshVersionFormatted";

class MeditReader {
 public:
  explicit MeditReader(const FileView& file) : text_(file), builder_(file) {}

  Mesh read() {
    if (word() != kFirstWord) text_.fail("a Medit file starts with MeshVersionFormatted; check that it is one");
    integer();
    for (std::string_view keyword = word(); !keyword.empty() && keyword != "End"; keyword = word()) {
      if (keyword == "Dimension")
        check_dimension();
      else if (keyword == "Vertices")
        read_vertices();
      else if (keyword == "Triangles")
        read_faces(3);
      else if (keyword == "Quadrilaterals")
        read_faces(4);
      else
        skip_rows(keyword);
    }
    return builder_.finish([](std::size_t v) { return "vertex " + std::to_string(v + 1); });
  }

 private:
  // To the next word, over comments.
  void skip() {
    for (text_.skip_space(); !text_.at_end() && *text_.position() == '#'; text_.skip_space()) text_.skip_line();
  }
  std::string_view word() {
    skip();
    return text_.word();
  }
  std::int64_t integer() {
    skip();
    return text_.number<std::int64_t>();
  }
  double coordinate() {
    skip();
    return text_.number<double>();
  }

  void check_dimension() {
    if (const auto dimension = integer(); dimension != 3)
      text_.fail("the mesh has " + std::to_string(dimension) +
                 " dimensions, and only 3 are read; add a z of 0 to its vertices");
  }

  // Rows of so many numbers and a reference.
  std::uint64_t count(const char* what, std::uint64_t numbers) {
    const auto rows = integer();
    // Of every number a digit and a space; the last space of the file may be missing.
    if (rows < 0 || static_cast<std::uint64_t>(rows) > (text_.left() + 1) / (2 * (numbers + 1)))
      text_.fail("it promises " + std::to_string(rows) + " " + what +
                 ", more than the file can hold; it is cut off or damaged, get all of it");
    return static_cast<std::uint64_t>(rows);
  }
  void skip_reference() {
    if (word().empty()) text_.fail("the file ends in the middle of its rows; it is cut off, get all of it");
  }

  void read_vertices() {
    const std::uint64_t rows = count("vertices", 3);
    if (!builder_.vertices.empty()) text_.fail("a second list of vertices; join them");
    builder_.vertices.reserve(rows);
    for (std::uint64_t row = 0; row < rows; ++row) {
      const double x = coordinate(), y = coordinate(), z = coordinate();
      builder_.vertices.push_back({x, y, z});
      skip_reference();
    }
  }

  void read_faces(std::size_t corners) {
    const std::uint64_t rows = count("faces", corners);
    builder_.triangles.reserve(builder_.triangles.size() + rows * (corners - 2));
    std::vector<std::uint32_t> face(corners);
    for (std::uint64_t row = 0; row < rows; ++row) {
      for (auto& corner : face) corner = index();
      builder_.add_face(face);
      skip_reference();
    }
  }

  // From 1 on. Vertices stand before the faces in every file there is.
  std::uint32_t index() {
    const auto number = integer();
    if (number < 1 || static_cast<std::uint64_t>(number) > builder_.vertices.size())
      text_.fail("vertex index " + std::to_string(number) + " is out of range, there are " +
                 std::to_string(builder_.vertices.size()) + " vertices here, counted from 1; repair the mesh");
    return static_cast<std::uint32_t>(number - 1);
  }

  // Rows of any width, to the next keyword.
  void skip_rows(std::string_view keyword) {
    if (!std::isalpha(static_cast<unsigned char>(keyword[0])))
      text_.fail_at(keyword.data(),
                    "expected a keyword, found " + in_quotes(keyword) + "; the file is damaged, write it again");
    for (skip(); !text_.at_end() && !std::isalpha(static_cast<unsigned char>(*text_.position())); skip()) text_.word();
  }

  TextCursor text_;
  MeshBuilder builder_;
};

bool is_medit(std::string_view content) {
  constexpr std::size_t kEnough = 4096;
  const FileView file("", content.substr(0, kEnough));
  TextCursor text(file);
  for (text.skip_space(); !text.at_end() && *text.position() == '#'; text.skip_space()) text.skip_line();
  return text.word() == kFirstWord;
}

Mesh read_medit(const FileView& file) { return MeditReader(file).read(); }

}  // namespace

constinit const MeshFormat kMeshMedit{"mesh", "Medit", "Medit, text", is_medit, as_is<read_medit>};

}  // namespace standoff
