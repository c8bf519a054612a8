// SPDX-License-Identifier: Apache-2.0
// A hash of the content of a mesh.
#include <tbb/parallel_invoke.h>

#include <array>
#include <bit>
#include <cstring>

#include "core/guarded.h"
#include "core/splitmix64.h"
#include "standoff/mesh.h"

namespace standoff {
namespace {

constexpr std::uint64_t mixed(std::uint64_t h, std::uint64_t value) { return splitmix64(h ^ value); }

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
