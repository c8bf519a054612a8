// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ: v and f statements; everything else is passed over.
#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <string_view>

#include "files/text.h"
#include "io/mesh/builder.h"
#include "io/mesh/format.h"

namespace standoff {
namespace {

// Indices beyond this cannot be kept; files that large do not exist.
constexpr std::int64_t kHighest = std::numeric_limits<std::uint32_t>::max();

// What begins like a number, or a v or f that its number has run into: no statement, but what is left of one. Passed
// over, it would shift all indices after it.
bool is_damaged(std::string_view keyword) {
  if (keyword == "V" || keyword == "F") return true;
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  if (keyword.size() > 1 && (keyword[0] == 'v' || keyword[0] == 'f')) keyword.remove_prefix(1);
  while (keyword.size() > 1 && (keyword[0] == '-' || keyword[0] == '+' || keyword[0] == '.')) keyword.remove_prefix(1);
  return !keyword.empty() && digit(keyword[0]);
}

// Some editors put a byte order mark before the text. Left there it would hide the first statement.
std::size_t text_begin(const FileView& file) { return file.bytes().starts_with("\xef\xbb\xbf") ? 3 : 0; }

class ObjReader {
 public:
  explicit ObjReader(const FileView& file) : file_(file), text_(file, text_begin(file)), builder_(file) {}

  Mesh read() {
    reserve();
    while (!text_.at_end()) {
      const std::string_view keyword = text_.statement_word();
      if (keyword == "v")
        read_vertex();
      else if (keyword == "f")
        read_face();
      else if (is_damaged(keyword))
        text_.fail_at(keyword.data(), "expected a statement such as \"v 1 2 3\" or \"f 1 2 3\", found " +
                                          in_quotes(keyword) + "; repair the line");
      skip_rest(text_, keyword);
    }
    if (highest_ > static_cast<std::int64_t>(builder_.vertices.size())) fail_range(highest_place_, highest_);
    return builder_.finish([&](std::size_t v) { return place_of_vertex(v); });
  }

 private:
  // One look at the beginnings of the lines saves the vectors from growing by copies.
  void reserve() {
    std::size_t vertices = 0, faces = 0;
    for (std::string_view rest = file_.bytes(); rest.size() > 1;) {
      vertices += rest[0] == 'v' && is_blank(rest[1]);
      faces += rest[0] == 'f' && is_blank(rest[1]);
      const auto end = rest.find('\n');
      rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
    }
    builder_.vertices.reserve(vertices);
    builder_.triangles.reserve(faces);
  }

  // A comment ends with its line, even if that ends with a backslash (as names of Windows folders do).
  static void skip_rest(TextCursor& text, std::string_view keyword) {
    if (keyword.starts_with('#'))
      text.skip_line();
    else
      text.skip_statement();
  }

  void read_vertex() {
    Vec3 vertex;
    for (double* c : {&vertex.x, &vertex.y, &vertex.z}) {
      text_.skip_blanks();
      *c = text_.number<double>();
    }
    // What follows is a weight or a colour.
    builder_.vertices.push_back(vertex);
  }

  void read_face() {
    face_.clear();
    for (;;) {
      text_.skip_blanks();
      if (text_.at_line_end() || *text_.position() == '#') break;
      face_.push_back(read_corner());
    }
    builder_.add_face(face_);
  }

  // "12", "12/3", "12//4", "12/3/4", or negative numbers, which count back from the latest vertex. Returns it from 0
  // on.
  std::uint32_t read_corner() {
    const char* place = text_.position();
    const std::int64_t given = text_.integer_prefix();
    if (text_.take('/'))
      text_.skip_word();
    else if (!text_.at_word_end())
      text_.fail_at(place, "expected a corner like 12 or 12/3/4 and then a space; repair the face");
    const std::int64_t number = given < 0 ? vertex_count() + given + 1 : given;
    if (number < 1 || number > kHighest) fail_range(place, given);
    // Vertices may follow their faces: whether this one does shows at the end.
    if (number > highest_) {
      highest_ = number;
      highest_place_ = place;
    }
    return static_cast<std::uint32_t>(number - 1);
  }

  std::int64_t vertex_count() const { return static_cast<std::int64_t>(builder_.vertices.size()); }

  [[noreturn]] void fail_range(const char* place, std::int64_t given) const {
    text_.fail_at(place, "vertex index " + std::to_string(given) + " is out of range, there are " +
                             std::to_string(vertex_count()) + " vertices here, counted from 1; repair the mesh");
  }

  std::string place_of_vertex(std::size_t vertex) const {
    TextCursor text(file_, text_begin(file_));
    while (!text.at_end()) {
      const std::string_view word = text.statement_word();
      if (word == "v" && vertex-- == 0) break;
      skip_rest(text, word);
    }
    return "line " + std::to_string(text.line());
  }

  const FileView& file_;
  TextCursor text_;
  MeshBuilder builder_;
  std::vector<std::uint32_t> face_;
  std::int64_t highest_ = 0;
  const char* highest_place_ = nullptr;
};

// The first statement must be one that meshes begin with, after comments and empty lines.
bool is_obj(std::string_view content) {
  constexpr std::array<std::string_view, 10> kFirst{"v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl", "vp"};
  constexpr std::size_t kEnough = 65536;
  const FileView file("", content.substr(0, kEnough));
  TextCursor text(file, text_begin(file));
  while (!text.at_end()) {
    const std::string_view word = text.statement_word();
    if (!word.empty() && word[0] != '#')
      return !text.at_line_end() && std::find(kFirst.begin(), kFirst.end(), word) != kFirst.end();
    text.skip_line();
  }
  return false;
}

Mesh read_obj(const FileView& file) { return ObjReader(file).read(); }

// Three numbers of at most 24 characters, a keyword, spaces and a line end.
class Line {
 public:
  explicit Line(char keyword) { *end_++ = keyword; }
  template <class Number>
  Line& add(Number number) {
    *end_++ = ' ';
    end_ = std::to_chars(end_, text_.data() + text_.size(), number).ptr;
    return *this;
  }
  void write(AtomicFile& file) {
    *end_++ = '\n';
    file.write(text_.data(), static_cast<std::size_t>(end_ - text_.data()));
  }

 private:
  std::array<char, 96> text_;
  char* end_ = text_.data();
};

// std::to_chars writes the shortest text that reads back as the same double.
void write_obj(AtomicFile& file, MeshView mesh) {
  constexpr std::string_view kFirst = "# written by standoff\n";
  file.write(kFirst.data(), kFirst.size());
  for (const Vec3& v : mesh.vertices) Line('v').add(v.x).add(v.y).add(v.z).write(file);
  for (const Triangle& t : mesh.triangles) {
    Line line('f');
    for (const auto v : t) line.add(std::uint64_t{v} + 1);
    line.write(file);
  }
}

}  // namespace

constinit const MeshFormat kMeshObj{"obj", "OBJ",  "Wavefront OBJ", is_obj, as_is<read_obj>, as_they_are<write_obj>,
                                    false, Axis::y};

}  // namespace standoff
