// SPDX-License-Identifier: Apache-2.0
// Meshes as pages hold them.

#include <algorithm>
#include <cmath>

#include "page/page.h"
#include "standoff/error.h"
#include "standoff/mesh.h"

#ifdef STANDOFF_HAVE_MESHOPT
#include <meshoptimizer.h>
#endif

namespace standoff::page {

#ifdef STANDOFF_HAVE_MESHOPT

bool can_simplify() { return true; }

std::vector<Triangle> simplified(std::span<const Triangle> triangles, std::span<const float> vertices, std::size_t most,
                                 float error) {
  std::vector<Triangle> out(triangles.size());
  const unsigned* const from = triangles.front().data();
  unsigned* const to = out.front().data();
  // This keeps the topology, and stops where that, or the error, holds it up.
  std::size_t indices = meshopt_simplify(to, from, 3 * triangles.size(), vertices.data(), vertices.size() / 3,
                                         3 * sizeof(float), 3 * most, error, 0, nullptr);
  if (indices > 3 * most && error < kAnyShape) return {};
  if (indices > 3 * most)
    indices = meshopt_simplifySloppy(to, from, 3 * triangles.size(), vertices.data(), vertices.size() / 3,
                                     3 * sizeof(float), 3 * most, error, nullptr);
  out.resize(indices / 3);
  out.shrink_to_fit();
  return out;
}

#else

bool can_simplify() { return false; }

std::vector<Triangle> simplified(std::span<const Triangle>, std::span<const float>, std::size_t, float) { return {}; }

#endif

namespace {

// A short edge of the mesh must have so many steps of the lattice: its direction is then known to half a degree, and
// flat shading does not show that corners were moved.
constexpr double kStepsPerEdge = 64;

// A tenth of the edges are shorter; 0 for a mesh without extent. A sample of some thousand edges is enough.
double short_edge(MeshView mesh) {
  std::vector<double> lengths;
  const std::size_t stride = mesh.triangles.size() / 4096 + 1;
  for (std::size_t n = 0; n < mesh.triangles.size(); n += stride) {
    const Triangle t = mesh.triangles[n];
    for (int k = 0; k < 3; ++k) {
      const double edge = length(mesh.vertices[t[k]] - mesh.vertices[t[(k + 1) % 3]]);
      if (edge > 0) lengths.push_back(edge);
    }
  }
  if (lengths.empty()) return 0;
  const auto tenth = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 10);
  std::nth_element(lengths.begin(), tenth, lengths.end());
  return *tenth;
}

// The triangles, with vertices numbered anew by first use; `used` says which vertex each was.
std::vector<Triangle> renumbered(MeshView mesh, std::vector<std::uint32_t>& used) {
  std::vector<std::uint32_t> number(mesh.vertices.size(), kNoTriangle);
  std::vector<Triangle> triangles(mesh.triangles.size());
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    const Triangle t = mesh.triangles[n];
    for (int k = 0; k < 3; ++k) {
      if (number[t[k]] == kNoTriangle) {
        number[t[k]] = static_cast<std::uint32_t>(used.size());
        used.push_back(t[k]);
      }
      triangles[n][k] = number[t[k]];
    }
  }
  return triangles;
}

std::string coded_positions(const LatticeMesh& mesh) {
  std::string bytes;
  std::vector<std::uint32_t> deltas(mesh.vertices.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::uint32_t last = 0;
    for (std::size_t n = 0; n < deltas.size(); ++n) {
      deltas[n] = zigzag(static_cast<std::int32_t>(mesh.vertices[n][axis] - last));
      last = mesh.vertices[n][axis];
    }
    put_planes(bytes, deltas, mesh.bits / 8 + 1);  // differences have one bit more, zigzag another
  }
  return bytes;
}

// How far below the next new vertex an index is: few bits, for most corners were named a moment ago.
std::string coded_by_first_use(std::span<const Triangle> triangles) {
  std::string bytes;
  std::uint32_t next = 0;
  for (const Triangle& t : triangles)
    for (const std::uint32_t index : t) {
      put_varint(bytes, next - index);
      if (index == next) ++next;
    }
  return bytes;
}

std::string coded_by_difference(std::span<const Triangle> triangles) {
  std::string bytes;
  std::uint32_t last = 0;
  for (const Triangle& t : triangles)
    for (const std::uint32_t index : t) {
      put_varint(bytes, zigzag(static_cast<std::int32_t>(index - last)));
      last = index;
    }
  return bytes;
}

}  // namespace

LatticeMesh lattice_mesh(MeshView mesh, const PageOptions& options, float proxy_error) {
  validate(mesh);
  const Box box = bounds(mesh);
  LatticeMesh made{.origin = box.min};
  const double side = box.longest_side();
  if (!std::isfinite(side))
    throw Error(ErrorCode::input, "mesh: its box is wider than any double; scale the mesh down");
  if (side / 65535 * kStepsPerEdge > short_edge(mesh)) made.bits = 24;
  const double steps = made.bits == 16 ? 65535 : 16777215;
  if (side / steps > 0) made.step = side / steps;

  std::vector<std::uint32_t> used;
  made.triangles = renumbered(mesh, used);
  const auto most = static_cast<std::size_t>(options.most_triangles);
  const auto proxy_most = static_cast<std::size_t>(options.proxy_triangles);
  if (made.triangles.size() > most && !can_simplify())
    throw Error(ErrorCode::limit, "mesh: " + std::to_string(made.triangles.size()) +
                                      " triangles are more than a page may hold, " + std::to_string(most) +
                                      ", and this standoff was built without meshoptimizer, which would simplify "
                                      "them; show a coarser mesh, or allow more triangles");
  if (made.triangles.size() > std::min(most, proxy_most)) {
    std::vector<float> vertices(3 * used.size());
    const double scale = side > 0 ? 1 / side : 1;
    for (std::size_t n = 0; n < used.size(); ++n) {
      const Vec3 at = (mesh.vertices[used[n]] - box.min) * scale;
      vertices[3 * n] = static_cast<float>(at.x);
      vertices[3 * n + 1] = static_cast<float>(at.y);
      vertices[3 * n + 2] = static_cast<float>(at.z);
    }
    if (made.triangles.size() > most) {
      made.triangles = simplified(made.triangles, vertices, most);
      made.simplified = true;
    }
    // Fewer than where a mesh is drawn as it is, so that a processor without a graphics card draws ten in a second.
    if (made.triangles.size() > proxy_most)
      made.proxy = simplified(made.triangles, vertices, proxy_most * 2 / 3, proxy_error);
  }
  if (made.simplified) {  // many vertices have no triangle now
    std::vector<Vec3> kept(used.size());
    for (std::size_t n = 0; n < used.size(); ++n) kept[n] = mesh.vertices[used[n]];
    const std::vector<Triangle> fewer = std::move(made.triangles);
    std::vector<std::uint32_t> still;
    made.triangles = renumbered({kept, fewer}, still);
    std::vector<std::uint32_t> number(used.size(), 0);
    for (std::size_t n = 0; n < still.size(); ++n) number[still[n]] = static_cast<std::uint32_t>(n);
    for (Triangle& t : made.proxy)
      for (std::uint32_t& index : t) index = number[index];
    for (std::uint32_t& vertex : still) vertex = used[vertex];
    used = std::move(still);
  }

  made.vertices.resize(used.size());
  const auto on_lattice = [&](double v) { return static_cast<std::uint32_t>(std::clamp(std::round(v), 0.0, steps)); };
  for (std::size_t n = 0; n < used.size(); ++n) {
    const Vec3 at = (mesh.vertices[used[n]] - box.min) / (Vec3{1, 1, 1} * made.step);  // 1/step may be infinite
    made.vertices[n] = {on_lattice(at.x), on_lattice(at.y), on_lattice(at.z)};
  }
  return made;
}

std::string mesh_blob(const PageMesh& mesh, const PageOptions& options, PageItem* held, float proxy_error) {
  const LatticeMesh made = lattice_mesh(mesh.mesh, options, proxy_error);
  const auto count = [](std::size_t n) { return json_number(static_cast<std::int64_t>(n)); };
  JsonObject header;
  header.add("kind", "\"mesh\"")
      .add("name", json_string(mesh.name))
      .add("triangles", count(made.triangles.size()))
      .add("vertices", count(made.vertices.size()))
      .add("proxy", count(made.proxy.size()))
      .add("given", count(mesh.mesh.triangles.size()))
      .add("simplified", json_bool(made.simplified))
      .add("origin", json_triple(made.origin))
      .add("step", json_number(made.step))
      .add("bits", json_number(std::int64_t{made.bits}));
  std::string bytes = packed_blob(header,
                                  {{"positions", coded_positions(made)},
                                   {"triangles", coded_by_first_use(made.triangles)},
                                   {"proxy", coded_by_difference(made.proxy)}},
                                  options.compression);
  if (held)
    *held = {.name = mesh.name,
             .bytes = static_cast<std::int64_t>(bytes.size()),
             .triangles = static_cast<std::int64_t>(made.triangles.size()),
             .proxy_triangles = static_cast<std::int64_t>(made.proxy.size()),
             .error = made.step * 0.500001};  // rounding itself is rounded
  return bytes;
}

}  // namespace standoff::page
