#include "difi/mesh.h"

#include <bit>
#include <string>

#include "difi/error.h"

namespace difi {

void validate(MeshView mesh) {
  if (mesh.triangles.empty()) throw Error(ErrorCode::input, "mesh: no triangles; give a mesh with at least one");
  const auto vertices = mesh.vertices.size();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const auto v : mesh.triangles[t]) {
      if (v >= vertices)
        throw Error(ErrorCode::input, "mesh: triangle " + std::to_string(t) + ": index " + std::to_string(v) +
                                          " is out of range, there are " + std::to_string(vertices) +
                                          " vertices; repair the mesh");
      if (!is_finite(mesh.vertices[v]))
        throw Error(ErrorCode::input, "mesh: triangle " + std::to_string(t) + ": vertex " + std::to_string(v) +
                                          " is not finite; repair the mesh");
    }
  }
}

Box bounds(MeshView mesh) {
  Box box;
  for (const auto& triangle : mesh.triangles)
    for (const auto v : triangle) box.include(mesh.vertices[v]);
  return box;
}

namespace {

// One round of the splitmix64 finaliser: every input bit reaches every output bit.
constexpr std::uint64_t mixed(std::uint64_t h, std::uint64_t value) {
  h = (h ^ value) + 0x9e3779b97f4a7c15u;
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
  return h ^ (h >> 31);
}

}  // namespace

std::uint64_t content_hash(MeshView mesh) {
  std::uint64_t h = mixed(mesh.vertices.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices)
    for (const double c : {v.x, v.y, v.z}) h = mixed(h, std::bit_cast<std::uint64_t>(c));
  for (const Triangle& t : mesh.triangles) h = mixed(mixed(h, (std::uint64_t{t[0]} << 32) | t[1]), t[2]);
  return h;
}

}  // namespace difi
