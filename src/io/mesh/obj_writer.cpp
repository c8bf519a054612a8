// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <string_view>

#include "io/mesh/format.h"

namespace standoff {
namespace {

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

}  // namespace

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

}  // namespace standoff
