// SPDX-License-Identifier: Apache-2.0
// Points in tables of text, and in arrays of NumPy.
#include <array>
#include <string>
#include <vector>

#include "tests/grammar/hostile.h"
#include "tests/grammar/packed.h"
#include "tests/grammar/shape.h"

namespace standoff::grammar {
namespace {

std::vector<Vec3> make_points(Choices& c) {
  std::vector<Vec3> points;
  const auto coordinate = [&] { return double(make_coordinate(c, false)); };
  for (std::uint32_t n = 1 + c.below(c.one_in(5) ? 300 : 6); n > 0; --n)
    points.push_back({coordinate(), coordinate(), coordinate()});
  return points;
}

double part(const Vec3& v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

}  // namespace

// Columns in any order if a line names them, and others among them; comments, blank lines, ends of lines of all kinds.
File make_csv_points(Choices& c) {
  File file;
  file.truth.points = make_points(c);
  constexpr const char* kSeparators[] = {",", ";", "\t", " ", ", "};
  constexpr const char* kEnds[] = {"\n", "\r\n"};
  const std::string between = c.pick(kSeparators), end = c.pick(kEnds);
  constexpr std::array<std::size_t, 3> kOrders[] = {{0, 1, 2}, {2, 0, 1}, {1, 0, 2}};
  const bool named = c.one_in(2);
  const std::array<std::size_t, 3> order = named ? c.pick(kOrders) : kOrders[0];
  const bool other_first = named && c.one_in(3), other_last = c.one_in(3), quoted = c.one_in(6);
  std::string& text = file.bytes;
  const auto line = [&](const auto& cell, const std::string& other) {
    const auto shown = [&](const std::string& words) { return quoted ? '"' + words + '"' : words; };
    if (other_first) text += shown(other) + between;
    for (std::size_t n = 0; n < 3; ++n) text += (n > 0 ? between : "") + shown(cell(order[n])) + noise(c);
    if (other_last) text += between + shown(other);
    text += end;
  };
  if (named) {
    constexpr const char *kLower[] = {"x", "y", "z"}, *kUpper[] = {"X", "Y", "Z"};
    const bool upper = c.one_in(3);
    line([&](std::size_t axis) { return word(c, upper ? kUpper[axis] : kLower[axis]); }, "weight");
  }
  for (const Vec3& p : file.truth.points) {
    if (c.one_in(12)) text += "# a comment" + end;
    if (c.one_in(12)) text += end;
    line([&](std::size_t axis) { return real(c, part(p, axis)); }, "7.5");
  }
  damage(c, text);
  return file;
}

File make_npy_points(Choices& c) {
  File file;
  file.truth.points = make_points(c);
  const bool fortran = c.one_in(3), big = c.one_in(4), narrow = c.one_in(3);
  const std::size_t count = file.truth.points.size();
  std::string bytes;
  for (std::size_t n = 0; n < 3 * count; ++n) {
    const double x = fortran ? part(file.truth.points[n % count], n / count) : part(file.truth.points[n / 3], n % 3);
    bytes += narrow ? raw(stored(c, static_cast<float>(x)), big) : raw(stored(c, x), big);
  }
  const std::string type = std::string(big ? ">" : "<") + (narrow ? "f4" : "f8");
  file.bytes = npy_array(c, type, "(" + whole(c, static_cast<std::int64_t>(count)) + ", 3)", fortran, bytes);
  damage(c, file.bytes);
  return file;
}

}  // namespace standoff::grammar
