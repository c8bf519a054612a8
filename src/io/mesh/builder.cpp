// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/builder.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/weld.h"
#include "standoff/error.h"

namespace standoff {
namespace {

struct Vec2 {
  double x, y;
  friend bool operator==(Vec2, Vec2) = default;
};

// Twice the signed area of abc.
double turn(Vec2 a, Vec2 b, Vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// Polygons seen along the coordinate axis closest to their normal, so that the normal looks at us. Dropping a
// coordinate, unlike a rotation, rounds nothing.
class View {
 public:
  // corner(i) for i from 0 to n - 1.
  template <class Corner>
  View(std::size_t n, const Corner& corner) {
    // Coordinates relative to the first corner, or the products of far ones would drown the sum.
    Vec3 normal;
    const Vec3 first = corner(0);
    for (std::size_t i = 1; i + 1 < n; ++i) normal = normal + cross(corner(i) - first, corner(i + 1) - first);
    const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    axis_ = z >= x && z >= y ? 2 : y >= x ? 1 : 0;
    turned_ = !((axis_ == 2 ? normal.z : axis_ == 1 ? normal.y : normal.x) >= 0);
  }

  Vec2 operator()(Vec3 p) const {
    const Vec2 seen = axis_ == 2 ? Vec2{p.x, p.y} : axis_ == 1 ? Vec2{p.z, p.x} : Vec2{p.y, p.z};
    return turned_ ? Vec2{seen.y, seen.x} : seen;
  }

 private:
  int axis_;
  bool turned_;
};

class EarCutter {
 public:
  explicit EarCutter(std::span<const Vec2> points) : points_(points) {
    const auto n = static_cast<std::uint32_t>(points.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      next_.push_back(i + 1 < n ? i + 1 : 0);
      previous_.push_back(i > 0 ? i - 1 : n - 1);
    }
    for (std::uint32_t i = 0; i < n; ++i)
      if (turn_at(i) < 0) reflex_.push_back(i);
    gone_.resize(n);
    // A stack: the lowest corner on top.
    for (std::uint32_t i = n; i-- > 0;) candidates_.push_back(i);
    left_ = n;
  }

  // Calls emit(a, b, c) for each triangle, corners in the polygon's order.
  template <class Emit>
  void cut(const Emit& emit) {
    while (left_ >= 3) {
      const std::uint32_t ear = next_ear();
      emit(previous_[ear], ear, next_[ear]);
      remove(ear);
    }
  }

 private:
  double turn_at(std::uint32_t i) const { return turn(points_[previous_[i]], points_[i], points_[next_[i]]); }

  // A corner that was no ear becomes one only when a neighbour of it goes, so each corner is tested once at first and
  // twice per triangle. Rounding and crossings can leave no ear; then any convex corner has to do.
  std::uint32_t next_ear() {
    while (!candidates_.empty()) {
      const std::uint32_t i = candidates_.back();
      candidates_.pop_back();
      if (!gone_[i] && is_ear(i)) return i;
    }
    while (gone_[first_]) ++first_;
    for (std::uint32_t i = first_;;) {
      if (turn_at(i) > 0) return i;
      i = next_[i];
      if (i == first_) return i;
    }
  }

  bool is_ear(std::uint32_t i) {
    const double at = turn_at(i);
    if (at < 0) return false;
    if (at == 0) return true;  // nothing fits into it
    const Vec2 a = points_[previous_[i]], b = points_[i], c = points_[next_[i]];
    std::erase_if(reflex_, [&](std::uint32_t r) { return gone_[r] || turn_at(r) >= 0; });
    return std::none_of(reflex_.begin(), reflex_.end(), [&](std::uint32_t r) {
      const Vec2 p = points_[r];
      // Corners at the same place do not block each other: outlines joined to their holes visit places twice.
      return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0 && !(p == a) && !(p == b) && !(p == c);
    });
  }

  void remove(std::uint32_t i) {
    gone_[i] = true;
    --left_;
    next_[previous_[i]] = next_[i];
    previous_[next_[i]] = previous_[i];
    candidates_.push_back(next_[i]);
    candidates_.push_back(previous_[i]);
  }

  std::span<const Vec2> points_;
  std::vector<std::uint32_t> next_, previous_;
  std::vector<std::uint32_t> reflex_;  // all reflex corners, and some that no longer are
  std::vector<std::uint32_t> candidates_;
  std::vector<bool> gone_;
  std::uint32_t first_ = 0;  // corners before it are gone
  std::uint32_t left_ = 0;
};

}  // namespace

bool triangulate(std::span<const Vec3> vertices, std::span<Triangle> fan, double& work) {
  if (fan.size() < 2) return true;
  const std::size_t n = fan.size() + 2;
  const auto index = [&](std::size_t i) { return i < 2 ? fan[0][i] : fan[i - 2][2]; };
  const auto corner = [&](std::size_t i) { return vertices[index(i)]; };
  // Nothing is kept of a convex one, which can have as many corners as a file has bytes.
  const View seen(n, corner);
  bool fits = true;
  const Vec2 first = seen(corner(0));
  for (std::size_t i = 1; i + 1 < n && fits; ++i) fits = turn(first, seen(corner(i)), seen(corner(i + 1))) >= 0;
  if (fits) return true;
  const double squares = static_cast<double>(n) * static_cast<double>(n);
  if (squares > work) return false;
  work -= squares;

  std::vector<std::uint32_t> indices;
  std::vector<Vec2> flat;
  for (std::size_t i = 0; i < n; ++i) {
    indices.push_back(index(i));
    flat.push_back(seen(corner(i)));
  }
  auto out = fan.begin();
  EarCutter(flat).cut([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    *out++ = {indices[a], indices[b], indices[c]};
  });
  return true;
}

void MeshBuilder::add_face(std::span<const std::uint32_t> corners) {
  if (corners.size() < 3) return;
  const std::size_t more = corners.size() - 2;
  if (corners.size() > 3) polygons_.push_back({triangles.size(), more});
  // One that is larger than all before gets what it needs, not twice as much.
  if (more > triangles.size() && more > triangles.capacity() - triangles.size())
    triangles.reserve(triangles.size() + more);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) triangles.push_back({corners[0], corners[i], corners[i + 1]});
}

Mesh MeshBuilder::finish(const std::function<std::string(std::size_t)>& where) {
  if (triangles.empty()) fail_no_triangles(file_);
  check_counts(file_, vertices.size(), triangles.size());
  check_indices();
  check_vertices(where);
  triangulate_polygons(where);

  Mesh mesh{std::move(vertices), std::move(triangles)};
  std::vector<std::uint32_t> number(mesh.vertices.size());
  const std::uint32_t distinct =
      weld([&](std::uint32_t i) { return mesh.vertices[i]; }, number, [&] { file_.check(); });
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < number.size(); ++i)
    if (number[i] == kept) mesh.vertices[kept++] = mesh.vertices[i] + kPositiveZero;
  if (distinct == number.size()) return mesh;
  mesh.vertices.resize(distinct);
  mesh.vertices.shrink_to_fit();
  for (Triangle& t : mesh.triangles)
    for (auto& v : t) v = number[v];
  return mesh;
}

void MeshBuilder::triangulate_polygons(const std::function<std::string(std::size_t)>& where) {
  std::size_t corners = 0;
  for (const Polygon& polygon : polygons_) corners += polygon.count + 2;
  double work = polygon_work(corners);
  std::size_t done = 0;
  for (const Polygon& polygon : polygons_) {
    if (++done % 1024 == 0) file_.check();
    const auto fan = std::span(triangles).subspan(polygon.first, polygon.count);
    if (!triangulate(vertices, fan, work))
      file_.fail(where(fan[0][0]), "the face that starts at this vertex has " + std::to_string(fan.size() + 2) +
                                       " corners and is not convex, and cutting all such faces would take too long; "
                                       "triangulate it in a modelling program");
  }
  polygons_ = {};
}

// Readers say better where a wrong index stands; this is what the memory of everything after it rests on.
void MeshBuilder::check_indices() const {
  std::uint32_t highest = 0;
  for (const Triangle& t : triangles) highest = std::max({highest, t[0], t[1], t[2]});
  if (highest >= vertices.size())
    file_.fail("", "vertex index " + std::to_string(highest) + " is out of range, there are " +
                       std::to_string(vertices.size()) + " vertices; repair the mesh");
}

// Nearly always all vertices are finite, and looking at them in order is cheap. Only otherwise does it matter which are
// in use: scanners mark missing points with NaN.
void MeshBuilder::check_vertices(const std::function<std::string(std::size_t)>& where) const {
  if (std::all_of(vertices.begin(), vertices.end(), is_finite)) return;
  for (const Triangle& t : triangles)
    for (const auto v : t)
      if (!is_finite(vertices[v])) file_.fail(where(v), kNotFinite);
}

void check_counts(const FileView& file, std::uint64_t vertices, std::uint64_t triangles) {
  // Of triangle numbers, too, one value is taken (kNoTriangle).
  if (vertices <= kMaxWeld && triangles <= kMaxWeld) return;
  throw Error(ErrorCode::limit, file.path().string() + ": " + std::to_string(std::max(vertices, triangles)) +
                                    " vertices or triangles, at most " + std::to_string(kMaxWeld) +
                                    " can be counted; split the mesh");
}

void fail_no_triangles(const FileView& file) {
  file.fail("", "the file holds no triangles; give a mesh with at least one");
}

}  // namespace standoff
