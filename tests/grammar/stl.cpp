// SPDX-License-Identifier: Apache-2.0
// STL, binary and text.
#include "tests/grammar/hostile.h"
#include "tests/grammar/shape.h"

namespace standoff::grammar {
namespace {

std::string binary(Choices& c, const std::vector<Corners>& triangles) {
  std::string header(80, ' ');
  // Many programs write "solid" into a binary header.
  const std::string title = c.one_in(3) ? "solid name" : c.one_in(2) ? std::string("\0\xff", 2) : "made";
  header.replace(0, title.size(), title);
  std::string bytes = header + raw(stored(c, static_cast<std::uint32_t>(triangles.size())));
  for (const Corners& triangle : triangles) {
    for (int axis = 0; axis < 3; ++axis) bytes += raw(c.one_in(9) ? std::numeric_limits<float>::quiet_NaN() : 0.0f);
    for (const Vec3& p : triangle)
      for (const double x : {p.x, p.y, p.z}) bytes += raw(stored(c, static_cast<float>(x)));
    bytes += raw(static_cast<std::uint16_t>(c.below(65536)));
  }
  // Some programs leave bytes behind; only where the header does not begin as a text would.
  if (!title.starts_with("solid") && c.one_in(8)) bytes += std::string(1 + c.below(60), '\0');
  return bytes;
}

std::string text(Choices& c, const std::vector<Corners>& triangles) {
  constexpr const char* kEnds[] = {"\n", "\r\n", "\r", " "};
  const std::string line = c.pick(kEnds), title_line = line == " " ? "\n" : line;
  const bool upper = c.one_in(6);
  const auto say = [&](const std::string& plain) {
    std::string said = word(c, plain);
    if (upper)
      for (char& letter : said) letter = letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 32) : letter;
    return (c.one_in(12) ? "\t " : " ") + said + noise(c);
  };
  std::string made = "solid " + word(c, "name") + title_line;
  for (const Corners& triangle : triangles) {
    made += say("facet") + say("normal") + " 0 0 " + (c.one_in(9) ? "nan" : "1") + line;
    made += say("outer") + say("loop") + line;
    for (const Vec3& p : triangle) {
      if (c.trick()) continue;
      made += say("vertex");
      for (const double x : {p.x, p.y, p.z}) made += " " + real(c, x);
      made += line;
    }
    made += say("endloop") + line + say("endfacet") + line;
    // Several solids in a file.
    if (c.one_in(24)) made += say("endsolid") + title_line + say("solid") + " next" + title_line;
  }
  return made + say("endsolid") + title_line;
}

}  // namespace

File make_stl(Choices& c) {
  const Shape shape = make_shape(c, Polygons::none, true);
  File file;
  add_triangles(shape, file.truth.triangles);
  file.bytes = c.one_in(2) ? text(c, file.truth.triangles) : binary(c, file.truth.triangles);
  damage(c, file.bytes);
  return file;
}

}  // namespace standoff::grammar
