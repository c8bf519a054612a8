#include "difi/mesh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include <array>
#include <cstring>
#include <functional>
#include <string>

#include "difi/error.h"

namespace difi {
namespace {

// Their indices fit in 32 bits.
constexpr std::uint64_t kMaxVertices = 0xffff'ffffu;

}  // namespace

namespace {

// Both go through memory in its own order, which is several times faster than from corner to corner.
using Positions = tbb::blocked_range<std::size_t>;
constexpr std::size_t kGrain = 16384;

bool indices_in_range(MeshView mesh) {
  const auto look = [&](const Positions& positions, bool good) {
    for (std::size_t t = positions.begin(); t < positions.end(); ++t)
      for (const auto v : mesh.triangles[t]) good &= v < mesh.vertices.size();
    return good;
  };
  return tbb::parallel_reduce(Positions(0, mesh.triangles.size(), kGrain), true, look, std::logical_and<>());
}

bool vertices_finite(MeshView mesh) {
  const auto look = [&](const Positions& positions, bool good) {
    for (std::size_t v = positions.begin(); v < positions.end(); ++v) good &= is_finite(mesh.vertices[v]);
    return good;
  };
  return tbb::parallel_reduce(Positions(0, mesh.vertices.size(), kGrain), true, look, std::logical_and<>());
}

}  // namespace

void validate(MeshView mesh) {
  if (mesh.triangles.empty()) throw Error(ErrorCode::input, "mesh: no triangles; give a mesh with at least one");
  const auto vertices = mesh.vertices.size();
  if (mesh.triangles.size() > kMaxTriangles || vertices > kMaxVertices)
    throw Error(ErrorCode::limit, "mesh: " + std::to_string(mesh.triangles.size()) + " triangles over " +
                                      std::to_string(vertices) + " vertices are more than " +
                                      std::to_string(kMaxTriangles) + " over " + std::to_string(kMaxVertices) +
                                      "; split the mesh");
  if (indices_in_range(mesh) && vertices_finite(mesh)) return;
  // Something is wrong, or a vertex that nothing uses is not finite: corner by corner.
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

// The hash of word(0), ..., word(count - 1) in eight chains side by side: one chain would wait for its own
// multiplications, and compute() hashes every mesh.
template <class Word>
std::uint64_t hash_of_words(std::size_t count, Word word) {
  constexpr std::size_t kChains = 8;
  std::array<std::uint64_t, kChains> chain{};
  std::size_t n = 0;
  for (; n + kChains <= count; n += kChains)
    for (std::size_t c = 0; c < kChains; ++c) chain[c] = mixed(chain[c], word(n + c));
  for (; n < count; ++n) chain[n % kChains] = mixed(chain[n % kChains], word(n));
  std::uint64_t h = count;
  for (const std::uint64_t end : chain) h = mixed(h, end);
  return h;
}

}  // namespace

std::uint64_t content_hash(MeshView mesh) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const auto* coordinates = reinterpret_cast<const char*>(mesh.vertices.data());
  std::uint64_t vertices = 0, triangles = 0;
  const auto hash_vertices = [&] {
    vertices = hash_of_words(3 * mesh.vertices.size(), [&](std::size_t n) {
      std::uint64_t bits;
      std::memcpy(&bits, coordinates + n * sizeof bits, sizeof bits);
      return bits;
    });
  };
  const auto hash_triangles = [&] {
    triangles = hash_of_words(2 * mesh.triangles.size(), [&](std::size_t n) {
      const Triangle& t = mesh.triangles[n / 2];
      return n % 2 == 0 ? (std::uint64_t{t[0]} << 32) | t[1] : t[2];
    });
  };
  tbb::parallel_invoke(hash_vertices, hash_triangles);
  return mixed(vertices, triangles);
}

}  // namespace difi
