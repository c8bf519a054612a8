// SPDX-License-Identifier: Apache-2.0
#include "sign/closed.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cstdint>

#include "core/position_hash.h"

namespace standoff {
namespace {

struct Hash {
  std::uint64_t a, b;
};

Hash hash_of(const Vec3& v) { return {position_hash(v), position_hash(v, 0x452821e638d01377u)}; }

// Sums over edges; they do not depend on the order of the triangles.
struct Sums {
  std::uint64_t signed_a = 0, signed_b = 0, odd_a = 0, odd_b = 0;

  void add(const Hash& from, const Hash& to) {
    if (from.a == to.a && from.b == to.b) return;
    // The same for both directions but for the sign.
    const bool forward = from.a != to.a ? from.a < to.a : from.b < to.b;
    const Hash& low = forward ? from : to;
    const Hash& high = forward ? to : from;
    const std::uint64_t a = folded_product(low.a ^ 0xeb44accab455d165, high.a ^ 0x9ddfea08eb382d69),
                        b = folded_product(low.b + 0xc2b2ae3d27d4eb4f, high.b + 0x165667b19e3779f9);
    signed_a += forward ? a : -a;
    signed_b += forward ? b : -b;
    odd_a ^= a;
    odd_b ^= b;
  }
  friend Sums operator+(const Sums& l, const Sums& r) {
    return {l.signed_a + r.signed_a, l.signed_b + r.signed_b, l.odd_a ^ r.odd_a, l.odd_b ^ r.odd_b};
  }
};

}  // namespace

Closed is_closed(MeshView mesh) {
  const Sums sums = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), 4096), Sums{},
      [&](const auto& range, Sums some) {
        for (std::size_t t = range.begin(); t != range.end(); ++t) {
          const auto [a, b, c] = mesh.corners(t);
          const Hash hash_a = hash_of(a), hash_b = hash_of(b), hash_c = hash_of(c);
          some.add(hash_a, hash_b);
          some.add(hash_b, hash_c);
          some.add(hash_c, hash_a);
        }
        return some;
      },
      std::plus<>());
  return {(sums.signed_a | sums.signed_b) == 0, (sums.odd_a | sums.odd_b) == 0};
}

}  // namespace standoff
