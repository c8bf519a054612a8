// SPDX-License-Identifier: Apache-2.0
// OBJ, OFF and Medit: statements and rows as the many programs write them.
#include <algorithm>

#include "tests/grammar/hostile.h"
#include "tests/grammar/packed.h"
#include "tests/grammar/shape.h"

namespace standoff::grammar {
namespace {

std::string line_end(Choices& c) {
  constexpr const char* kEnds[] = {"\n", "\r\n", "\r"};
  return c.pick(kEnds);
}

class Obj {
 public:
  explicit Obj(Choices& c) : c_(c), line_(line_end(c)) {}

  File make() {
    const Shape shape = make_shape(c_, Polygons::some, true);
    if (c_.one_in(10)) text_ = "\xef\xbb\xbf";
    if (c_.one_in(3)) text_ += "# mesh" + line_;
    if (c_.one_in(4)) text_ += "mtllib " + (c_.one_in(2) ? "a.mtl" : bad_path(c_)) + line_;
    if (c_.one_in(4)) text_ += "o name" + line_;
    const bool faces_first = c_.one_in(6);
    text_ += "v 0 0 0" + line_;  // so that the first statement is one that meshes begin with
    if (faces_first) faces(shape, true);
    for (const Vec3& p : shape.points) vertex(p);
    if (!faces_first) faces(shape, false);
    File file{text_, {}, {}};
    damage(c_, file.bytes);
    add_triangles(shape, file.truth.triangles);
    return file;
  }

 private:
  // Also a backslash that continues the line.
  std::string blank() { return c_.one_in(20) ? " \\" + line_ : c_.one_in(10) ? "\t " : " "; }
  void end() {
    text_ += (c_.one_in(8) ? " " : "") + line_;
    text_ += noise(c_);
    if (c_.one_in(12)) text_ += statement() + line_;
    if (c_.trick()) text_ += word(c_, "f 1 2 3") + line_;
  }
  std::string statement() {
    constexpr const char* kOthers[] = {"vn 0 0 1", "vt 0.5 0.5", "g a b",  "usemtl m",     "s off",
                                       "l 1 1",    "p 1",        "# c \\", "curv 0 1 1 1", ""};
    return c_.pick(kOthers);
  }

  void vertex(const Vec3& p) {
    text_ += word(c_, "v");
    for (const double x : {p.x, p.y, p.z})
      if (!c_.trick()) text_ += blank() + real(c_, x);
    if (c_.one_in(8)) text_ += " 1.0";
    if (c_.one_in(8)) text_ += " 0.1 0.2 0.3";
    end();
  }

  // Of the corners the first vertex, which no face uses, is number 1.
  void faces(const Shape& shape, bool before) {
    const auto points = static_cast<std::int64_t>(shape.points.size());
    if (c_.trick()) huge_face();
    for (const auto& face : shape.faces) {
      text_ += word(c_, "f");
      const bool back = !before && c_.one_in(4);
      for (const auto corner : face) {
        const std::int64_t number = back ? std::int64_t{corner} - points : std::int64_t{corner} + 2;
        constexpr const char* kTails[] = {"", "", "/1", "//1", "/1/1", "/"};
        text_ += blank() + whole(c_, number) + c_.pick(kTails);
      }
      end();
    }
  }
  void huge_face() {
    text_ += "f";
    for (std::uint32_t n = c_.many(); n > 0; --n) text_ += " " + std::to_string(1 + c_.below(5));
    text_ += line_;
  }

  Choices& c_;
  std::string line_, text_;
};

std::string off_row_end(Choices& c, const std::string& line) {
  return (c.one_in(10) ? " # remark" : "") + line + (c.one_in(16) ? "# remark" + line : "") + noise(c);
}

}  // namespace

File make_obj(Choices& c) { return Obj(c).make(); }

File make_obj_gz(Choices& c) {
  File file = make_obj(c);
  file.bytes = gzipped(c, file.bytes);
  return file;
}

File make_off(Choices& c) {
  const std::string line = line_end(c);
  const Shape shape = make_shape(c, Polygons::some, true);
  constexpr const char* kKeywords[] = {"OFF", "COFF", "NOFF", "STOFF", "CNOFF"};
  std::string text = word(c, c.pick(kKeywords)) + (c.one_in(3) ? " " : off_row_end(c, line));
  text += whole(c, static_cast<std::int64_t>(shape.points.size())) + " " +
          whole(c, static_cast<std::int64_t>(shape.faces.size())) + (c.one_in(4) ? "" : " 0") + line;
  for (const Vec3& p : shape.points) {
    for (const double x : {p.x, p.y, p.z}) text += real(c, x) + (c.one_in(6) ? "\t " : " ");
    if (c.one_in(6)) text += "0.5 0.5 0.5";
    text += off_row_end(c, line);
  }
  for (const auto& face : shape.faces) {
    text += whole(c, static_cast<std::int64_t>(face.size()));
    for (const auto corner : face) text += " " + whole(c, corner);
    if (c.one_in(6)) text += " 255 0 0";
    text += off_row_end(c, line);
  }
  if (c.trick()) {
    const std::uint32_t corners = c.many();
    text += std::to_string(corners);
    for (std::uint32_t n = 0; n < corners; ++n) text += " " + std::to_string(c.below(3));
  }
  File file{text, {}, {}};
  damage(c, file.bytes);
  add_triangles(shape, file.truth.triangles);
  return file;
}

File make_medit(Choices& c) {
  const std::string line = line_end(c);
  Shape shape = make_shape(c, Polygons::some, true);
  for (auto& face : shape.faces)
    if (face.size() < 3 || face.size() > 4) face = {0, 1, 2};
  // Triangles come first or last, all together.
  const bool quads_first = c.one_in(3);
  std::ranges::stable_sort(shape.faces, [&](const auto& a, const auto& b) {
    return quads_first ? a.size() > b.size() : a.size() < b.size();
  });
  const auto gap = [&] { return c.one_in(12) ? line : c.one_in(6) ? "\t " : " "; };
  const auto end = [&] { return (c.one_in(12) ? " # remark" : "") + line + noise(c); };
  const auto others = [&] {
    if (!c.one_in(4)) return std::string();
    return std::string(c.one_in(2) ? "Corners" : "Edges") + line + "2" + line + "1 1 0" + line + "2 1 0" + line;
  };
  std::string text = c.one_in(6) ? "# mesh" + line : "";
  text += word(c, "MeshVersionFormatted") + gap() + whole(c, 1 + c.below(2)) + end();
  text += word(c, "Dimension") + gap() + whole(c, 3) + end() + others();
  text += word(c, "Vertices") + gap() + whole(c, static_cast<std::int64_t>(shape.points.size())) + line;
  for (const Vec3& p : shape.points) {
    for (const double x : {p.x, p.y, p.z}) text += real(c, x) + gap();
    text += whole(c, c.below(3)) + end();
  }
  for (const std::size_t corners : {quads_first ? 4 : 3, quads_first ? 3 : 4}) {
    text += others();
    const auto of_kind = std::ranges::count(shape.faces, corners, &std::vector<std::uint32_t>::size);
    if (of_kind == 0 && c.one_in(2)) continue;
    text += word(c, corners == 3 ? "Triangles" : "Quadrilaterals") + gap() + whole(c, of_kind) + line;
    for (const auto& face : shape.faces) {
      if (face.size() != corners) continue;
      for (const auto corner : face) text += whole(c, std::int64_t{corner} + 1) + gap();
      text += whole(c, c.below(3)) + end();
    }
  }
  if (!c.one_in(4)) text += word(c, "End") + line;
  File file{text, {}, {}};
  damage(c, file.bytes);
  add_triangles(shape, file.truth.triangles);
  return file;
}

}  // namespace standoff::grammar
