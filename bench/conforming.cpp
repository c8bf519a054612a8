// SPDX-License-Identifier: Apache-2.0
#include "conforming.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>

#include "scenes/frame.h"
#include "scenes/scenes.h"
#include "standoff/io.h"
#include "standoff/surface.h"

namespace standoff::bench {
namespace {

using scenes::normalized;

constexpr double kTurn = 2 * std::numbers::pi;

Vec3 around(double radius, double turns, double y) {
  return {radius * std::cos(kTurn * turns), y, radius * std::sin(kTurn * turns)};
}

// How often a sheet is divided along u and v.
struct Pieces {
  int u, v;
};
// Of so many triangles, with `ratio` times as many pieces along u as along v.
Pieces pieces_of(std::int64_t triangles, double ratio) {
  const double v = std::sqrt(static_cast<double>(triangles) / 2 / ratio);
  return {std::max(3, static_cast<int>(std::lround(v * ratio))), std::max(3, static_cast<int>(std::lround(v)))};
}

// Adds the sheet of points at(u, v), both from 0 to 1, of which u comes around, and v too if it is `closed`.
template <class At>
void add_sheet(Mesh& mesh, Pieces pieces, bool closed, At at) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const int rows = closed ? pieces.v : pieces.v + 1;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < pieces.u; ++i) mesh.vertices.push_back(at(double(i) / pieces.u, double(j) / pieces.v));
  const auto index = [&](int i, int j) {
    return first + static_cast<std::uint32_t>(i % pieces.u + pieces.u * (j % rows));
  };
  for (int j = 0; j < pieces.v; ++j)
    for (int i = 0; i < pieces.u; ++i) {
      mesh.triangles.push_back({index(i, j), index(i, j + 1), index(i + 1, j + 1)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i + 1, j)});
    }
}

// Adds a loop of (radius, y) turned about the y axis.
template <class Loop>
void add_turned(Mesh& mesh, Pieces pieces, Loop loop) {
  add_sheet(mesh, pieces, true, [&](double u, double v) {
    const auto [radius, y] = loop(v, u);
    return around(radius, u, y);
  });
}

// A rectangle of radii and heights, walked once: as long along y as the pieces allow.
std::array<double, 2> on_rectangle(double inner, double outer, double half_height, double v) {
  constexpr double kEnds = 0.05;  // of the way: on each end
  const double side = 0.5 - kEnds, height = 2 * half_height;
  if (v < side) return {outer, -half_height + height * (v / side)};
  if (v < 0.5) return {outer + (inner - outer) * ((v - side) / kEnds), half_height};
  if (v < 0.5 + side) return {inner, half_height - height * ((v - 0.5) / side)};
  return {inner + (outer - inner) * ((v - 0.5 - side) / kEnds), -half_height};
}

Mesh shell(double radius, std::int64_t triangles) {
  Mesh mesh = scenes::make("sphere", triangles / 2);
  const auto corners = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::size_t of_outer = mesh.triangles.size();
  for (std::uint32_t n = 0; n < corners; ++n) mesh.vertices.push_back(mesh.vertices[n] * (0.99 * radius));
  for (std::uint32_t n = 0; n < corners; ++n) mesh.vertices[n] = mesh.vertices[n] * radius;
  for (std::size_t n = 0; n < of_outer; ++n) {
    const auto [a, b, c] = mesh.triangles[n];
    mesh.triangles.push_back({a + corners, c + corners, b + corners});
  }
  return mesh;
}

Mesh plate(std::int64_t triangles) {
  Mesh mesh;
  const int n = std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(triangles) / 4))));
  for (const double y : {-0.1, 0.0}) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) mesh.vertices.push_back({10.0 * i / n - 5, y, 10.0 * j / n - 5});
    const auto index = [&](int i, int j) { return first + static_cast<std::uint32_t>(i + (n + 1) * j); };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        mesh.triangles.push_back({index(i, j), index(i, j + 1), index(i + 1, j + 1)});
        mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i + 1, j)});
      }
  }
  return mesh;
}

constexpr double kShaftHalf = 3;

Mesh shaft(std::int64_t triangles) {
  Mesh mesh;
  add_sheet(mesh, pieces_of(triangles, 2), false, [](double u, double v) {
    constexpr double kEnds = 0.05;
    const double r = std::clamp(std::min(v, 1 - v) / kEnds, 0.02, 1.0);  // a point would make triangles of no area
    return around(r, u, kShaftHalf * std::clamp((2 * v - 1) / (1 - 2 * kEnds), -1.0, 1.0));
  });
  return mesh;
}

// The inner surface of a sleeve has corners on a circle too: its sides come nearer to the axis than they.
Mesh sleeve(double clearance, std::int64_t triangles) {
  Mesh mesh;
  const Pieces pieces = pieces_of(triangles, 1);
  const double inner = (1 + clearance) / std::cos(kTurn / 2 / pieces.u);
  add_turned(mesh, pieces, [&](double v, double) { return on_rectangle(inner, 1.3, kShaftHalf, v); });
  return mesh;
}

constexpr double kPitch = 0.5, kThread = 0.1, kBoltHalf = 2, kNutHalf = 0.8;

// The radius of a thread: it climbs by a pitch in each turn.
double thread(double y, double turns) {
  const double way = y / kPitch - turns;
  return 1 + kThread * std::abs(2 * (way - std::floor(way)) - 1);
}

Mesh bolt(std::int64_t triangles) {
  Mesh mesh;
  add_sheet(mesh, pieces_of(triangles, 1), false, [](double u, double v) {
    const double y = kBoltHalf * (2 * v - 1);
    return around(thread(y, u), u, y);
  });
  return mesh;
}

Mesh nut(double clearance, std::int64_t triangles) {
  Mesh mesh;
  add_turned(mesh, pieces_of(triangles, 1), [&](double v, double u) {
    std::array<double, 2> at = on_rectangle(1, 1.5, kNutHalf, v);
    if (at[0] == 1) at[0] = thread(at[1], u) + clearance;
    return at;
  });
  return mesh;
}

Mesh gear(std::int64_t triangles) {
  constexpr double kTeeth = 24, kRadius = 4.9, kTooth = 0.4;
  Mesh mesh;
  add_turned(mesh, pieces_of(triangles, 4), [&](double v, double u) {
    const double outer = kRadius + kTooth * std::clamp(1.6 * std::cos(kTurn * kTeeth * u), -1.0, 1.0);
    return on_rectangle(1, outer, 0.5, v);
  });
  return mesh;
}

// A tube along a closed curve.
template <class Curve>
void add_tube(Mesh& mesh, Pieces pieces, double radius, Curve curve) {
  add_sheet(mesh, pieces, true, [&](double u, double v) {
    constexpr double kStep = 1e-5;
    const Vec3 along = normalized(curve(v + kStep) - curve(v - kStep));
    const Vec3 side = normalized(cross(along, {0, 1, 1e-3})), up = cross(side, along);
    return curve(v) + (side * std::cos(kTurn * u) + up * std::sin(kTurn * u)) * radius;
  });
}

Mesh knot(std::int64_t triangles) {
  Mesh mesh;
  add_tube(mesh, pieces_of(triangles, 0.1), 0.35, [](double v) {
    const double radius = 2 + std::cos(3 * kTurn * v);
    return Vec3{radius * std::cos(2 * kTurn * v), std::sin(3 * kTurn * v), radius * std::sin(2 * kTurn * v)};
  });
  return mesh;
}

// Links along x, each turned by a quarter beside the one before; their holes are a little wider than two bars.
Mesh chain(int which, std::int64_t triangles) {
  constexpr int kLinks = 11;
  constexpr double kBar = 0.3, kPlay = 0.1, kEnd = 1,
                   kHalf = 1;  // a link: two half circles, straight bars between them
  constexpr double kNext = 2 * (kHalf + kEnd) - 2 * kBar - kPlay;
  Mesh mesh;
  for (int link = which; link < kLinks; link += 2)
    add_tube(mesh, pieces_of(triangles / ((kLinks + 1 - which) / 2), 0.25), kBar, [&](double v) {
      const double c = kEnd * std::cos(kTurn * v), s = kEnd * std::sin(kTurn * v);
      const double x = c + std::copysign(std::min(kHalf, 20 * std::abs(c)), c);
      const double at = kNext * link;
      return link % 2 == 0 ? Vec3{at + x, s, 0} : Vec3{at + x, 0, s};
    });
  return mesh;
}

Mesh fan(double upwards, std::int64_t triangles) {
  Mesh mesh;
  mesh.vertices.push_back({});
  const auto n = static_cast<std::uint32_t>(triangles);
  for (std::uint32_t i = 0; i < n; ++i) mesh.vertices.push_back(around(1, double(i) / n, upwards));
  for (std::uint32_t i = 0; i < n; ++i) mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  return mesh;
}

Mesh stack(std::int64_t triangles) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0.3, 0.2, 1}}, {}};
  mesh.triangles.assign(static_cast<std::size_t>(triangles), Triangle{0, 1, 2});
  return mesh;
}

Mesh glove(double apart, const std::string& file) {
  Mesh mesh = read_mesh(file).mesh;
  const Box box = bounds(mesh);
  for (Vec3& v : mesh.vertices) v = (v - box.center()) * (100 / box.longest_side());
  SurfaceOptions options{.at = 100 * apart};
  const Vec3 room = Vec3{2, 2, 2} * options.at;
  const Box around = bounds(mesh);
  return surface(mesh, fit_resolution({around.min - room, around.max + room}, 200), options).mesh;
}

// The words of a name between its colons.
std::array<std::string, 3> words_of(const std::string& name) {
  std::array<std::string, 3> words;
  std::size_t at = 0;
  for (std::size_t n = 0; n < 3 && at <= name.size(); ++n) {
    const std::size_t end = n == 2 ? name.size() : std::min(name.find(':', at), name.size());
    words[n] = name.substr(at, end - at);
    at = end + 1;
  }
  return words;
}

struct Entry {
  const char* name;
  std::int64_t triangles;
  Mesh (*make)(double number, const std::string& file, std::int64_t triangles);
};
const Entry kBodies[] = {
    {"shell", 72'000, [](double number, const std::string&, std::int64_t n) { return shell(number, n); }},
    {"plate", 101'124, [](double, const std::string&, std::int64_t n) { return plate(n); }},
    {"shaft", 80'000, [](double, const std::string&, std::int64_t n) { return shaft(n); }},
    {"sleeve", 90'000, [](double number, const std::string&, std::int64_t n) { return sleeve(number, n); }},
    {"bolt", 120'000, [](double, const std::string&, std::int64_t n) { return bolt(n); }},
    {"nut", 38'400, [](double number, const std::string&, std::int64_t n) { return nut(number, n); }},
    {"gear", 30'240, [](double, const std::string&, std::int64_t n) { return gear(n); }},
    {"knot", 60'000, [](double, const std::string&, std::int64_t n) { return knot(n); }},
    {"chain", 60'000, [](double number, const std::string&, std::int64_t n) { return chain(number != 0, n); }},
    {"fan", 20'000, [](double number, const std::string&, std::int64_t n) { return fan(number < 0 ? -1 : 1, n); }},
    {"stack", 30'000, [](double, const std::string&, std::int64_t n) { return stack(n); }},
    {"glove", 0, [](double number, const std::string& file, std::int64_t) { return glove(number, file); }},
};

const Entry* find(const std::string& name) {
  const auto found = std::ranges::find(kBodies, name, &Entry::name);
  return found == std::end(kBodies) ? nullptr : found;
}

}  // namespace

bool is_conforming(const std::string& name) { return find(words_of(name)[0]) != nullptr; }

Mesh make_conforming(const std::string& name, std::int64_t triangles) {
  const auto [what, number, file] = words_of(name);
  const Entry* const entry = find(what);
  if (entry == nullptr) throw std::invalid_argument("no such body: " + name);
  return entry->make(std::strtod(number.c_str(), nullptr), file, triangles > 0 ? triangles : entry->triangles);
}

}  // namespace standoff::bench
