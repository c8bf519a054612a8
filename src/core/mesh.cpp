// SPDX-License-Identifier: Apache-2.0
// Meshes: bounds, validation, and a hash of the content.
#include "standoff/mesh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include <array>
#include <bit>
#include <cstring>
#include <functional>
#include <string>

#include "core/guarded.h"
#include "core/hashes.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// Throws Error{input} about a triangle.
[[noreturn]] void fail_triangle(std::size_t triangle, const std::string& what) {
  throw Error(ErrorCode::input, "mesh: triangle " + std::to_string(triangle) + ": " + what + "; repair the mesh",
              {.triangle = static_cast<std::int64_t>(triangle)});
}

// Throws Error{input} about the k-th index of a triangle, which is out of range.
[[noreturn]] void fail_index(const MeshView& mesh, std::size_t triangle, int k) {
  fail_triangle(triangle, "index " + std::to_string(mesh.triangles.index(triangle, k)) +
                              " is out of range, there are " + std::to_string(mesh.vertices.size()) + " vertices");
}

}  // namespace

Box bounds(MeshView mesh) try {
  Box box;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle triangle = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      if (triangle[k] >= mesh.vertices.size()) fail_index(mesh, t, k);
      box.include(mesh.vertices[triangle[k]]);
    }
  }
  return box;
} catch (...) {
  throw_as_error("mesh");
}

namespace {

// Vertex indices fit in 32 bits.
constexpr std::uint64_t kMaxVertices = 0xffff'ffffu;

// Vertices and triangles are checked in the order of memory, which is several times faster than corner by corner.
using VertexRange = tbb::blocked_range<std::size_t>;
constexpr std::size_t kVertexGrain = 16384;

// Packed arrays have their own loop, which the compiler vectorises.
template <class Array, class Look>
void each_in_memory(const Array& array, const VertexRange& positions, Look look) {
  if (const auto packed = array.as_span())
    for (std::size_t n = positions.begin(); n < positions.end(); ++n) look((*packed)[n]);
  else
    for (std::size_t n = positions.begin(); n < positions.end(); ++n) look(array[n]);
}

bool indices_in_range(MeshView mesh) {
  const auto look = [&](const VertexRange& positions, bool good) {
    each_in_memory(mesh.triangles, positions, [&](const Triangle& t) {
      for (const std::uint32_t v : t) good &= v < mesh.vertices.size();
    });
    return good;
  };
  return tbb::parallel_reduce(VertexRange(0, mesh.triangles.size(), kVertexGrain), true, look, std::logical_and<>());
}

bool vertices_finite(MeshView mesh) {
  const auto look = [&](const VertexRange& positions, bool good) {
    each_in_memory(mesh.vertices, positions, [&](const Vec3& v) { good &= is_finite(v); });
    return good;
  };
  return tbb::parallel_reduce(VertexRange(0, mesh.vertices.size(), kVertexGrain), true, look, std::logical_and<>());
}

}  // namespace

void validate(MeshView mesh) try {
  if (mesh.triangles.empty()) throw Error(ErrorCode::input, "mesh: no triangles; give a mesh with at least one");
  const auto vertices = mesh.vertices.size();
  if (!mesh.triangles.data() || (vertices > 0 && !mesh.vertices.data()))
    throw Error(ErrorCode::usage, "mesh: an array is null but said not to be empty; give its address");
  if (mesh.triangles.size() > kMaxTriangles || vertices > kMaxVertices)
    throw Error(ErrorCode::limit, "mesh: " + std::to_string(mesh.triangles.size()) + " triangles over " +
                                      std::to_string(vertices) + " vertices are more than " +
                                      std::to_string(kMaxTriangles) + " over " + std::to_string(kMaxVertices) +
                                      "; split the mesh");
  if (indices_in_range(mesh) && vertices_finite(mesh)) return;
  // Something is wrong, or an unused vertex is not finite: check corner by corner.
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle triangle = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      if (triangle[k] >= vertices) fail_index(mesh, t, k);
      if (!is_finite(mesh.vertices[triangle[k]]))
        fail_triangle(t, "vertex " + std::to_string(triangle[k]) + " is not finite");
    }
  }
} catch (...) {
  throw_as_error("mesh");
}

namespace {

constexpr std::uint64_t mixed(std::uint64_t h, std::uint64_t value) { return splitmix64(h ^ value); }

// The hash of word(0), ..., word(count - 1), in eight independent chains: a single chain would wait for its own
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

std::uint64_t content_hash(MeshView mesh) try {
  std::uint64_t vertices = 0, triangles = 0;
  const auto hash_vertices = [&] {
    if (const auto packed = mesh.vertices.as_span()) {
      const auto* coordinates = reinterpret_cast<const char*>(packed->data());
      vertices = hash_of_words(3 * packed->size(), [&](std::size_t n) {
        std::uint64_t bits;
        std::memcpy(&bits, coordinates + n * sizeof bits, sizeof bits);
        return bits;
      });
    } else {
      vertices = hash_of_words(3 * mesh.vertices.size(), [&](std::size_t n) {
        const Vec3 v = mesh.vertices[n / 3];
        return std::bit_cast<std::uint64_t>(v[n % 3]);
      });
    }
  };
  const auto hash_triangles = [&] {
    const auto hash = [](const auto& all) {
      return hash_of_words(2 * all.size(), [&](std::size_t n) {
        const Triangle& t = all[n / 2];
        return n % 2 == 0 ? (std::uint64_t{t[0]} << 32) | t[1] : t[2];
      });
    };
    const auto packed = mesh.triangles.as_span();
    triangles = packed ? hash(*packed) : hash(mesh.triangles);
  };
  tbb::parallel_invoke(hash_vertices, hash_triangles);
  return mixed(vertices, triangles);
} catch (...) {
  throw_as_error("mesh");
}

}  // namespace standoff
