// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/builder.h"

#include <algorithm>
#include <utility>

#include "core/weld.h"
#include "io/mesh/polygon.h"
#include "standoff/error.h"

namespace standoff {

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
