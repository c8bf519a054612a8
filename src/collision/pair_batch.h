// SPDX-License-Identifier: Apache-2.0
// Pairs of triangles, collected to be decided eight at a time.
#pragma once

#include <utility>

#include "collision/query_pair.h"
#include "geometry/triangle_pair.h"

namespace standoff::collision {

class PairBatch {
 public:
  explicit PairBatch(const QueryPair& pair)
      : pair_(pair),
        kernels_(pair.kernels),
        transform_p_(transform_of(pair.target.pose)),
        transform_q_(transform_of(pair.probe.pose)) {}

  bool full() const { return count_ == kPairs; }

  /// Adds a pair by its BVH indices. Requires that the batch is not full.
  void add(std::uint32_t target_index, std::uint32_t probe_index) {
    const auto put = [this](double(&to)[3][3][kPairs], const Corners& corners) {
      for (int k = 0; k < 3; ++k)
        to[k][0][count_] = corners[k].x, to[k][1][count_] = corners[k].y, to[k][2][count_] = corners[k].z;
    };
    put(pairs_.p, pair_.target.body->corners[target_index]);
    put(pairs_.q, pair_.probe.body->corners[probe_index]);
    target_[count_] = target_index, probe_[count_] = probe_index;
    ++count_;
  }

  /// Decides the pairs in the order they were added, and calls use(target index, probe index, intersecting, where),
  /// until it returns false. False when it did; no pair is left afterwards. `where()` gives the Penetration of those
  /// that intersect.
  template <class Use>
  bool settle(Use use) {
    PairOverlaps overlap;
    const int count = take(kernels_.overlap_pairs, overlap);
    const auto is = [](std::uint32_t bits, int n) { return (bits >> n & 1) != 0; };
    for (int n = 0; n < count; ++n) {
      const auto p = [&] { return pair_.target.world(target_[n]); };
      const auto q = [&] { return pair_.probe.world(probe_[n]); };
      const auto where = [&]() -> Penetration {
        if (is(overlap.unsure | overlap.inaccurate, n)) return penetration(p(), q());
        return {{overlap.point[0][n], overlap.point[1][n], overlap.point[2][n]},
                {overlap.normal[0][n], overlap.normal[1][n], overlap.normal[2][n]},
                overlap.depth[n]};
      };
      const bool intersecting = is(overlap.intersecting, n) || (is(overlap.unsure, n) && triangles_intersect(p(), q()));
      if (!use(target_[n], probe_[n], intersecting, where)) return false;
    }
    return true;
  }

  /// Measures the pairs, which must not intersect, and calls use(target index, probe index, squared distance, point of
  /// the target's triangle, point of the probe's).
  template <class Use>
  void measure(Use use) {
    ClosestOfPairs found;
    const int count = take(kernels_.closest, found);
    for (int n = 0; n < count; ++n)
      use(target_[n], probe_[n], found.distance_sq[n], Vec3{found.on_p[0][n], found.on_p[1][n], found.on_p[2][n]},
          Vec3{found.on_q[0][n], found.on_q[1][n], found.on_q[2][n]});
  }

 private:
  // Runs a kernel on the pairs; returns how many they were.
  template <class Kernel, class Result>
  int take(Kernel kernel, Result& result) {
    if (count_ == 0) return 0;
    for (int n = count_; n < kPairs; ++n)
      for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis)
          pairs_.p[k][axis][n] = pairs_.p[k][axis][0], pairs_.q[k][axis][n] = pairs_.q[k][axis][0];
    kernel(pairs_, pair_.target.moved ? &transform_p_ : nullptr, pair_.probe.moved ? &transform_q_ : nullptr, result);
    return std::exchange(count_, 0);
  }

  const QueryPair& pair_;
  const Kernels& kernels_;
  const DoubleTransform transform_p_, transform_q_;
  TrianglePairs pairs_;
  std::uint32_t target_[kPairs], probe_[kPairs];
  int count_ = 0;
};

}  // namespace standoff::collision
