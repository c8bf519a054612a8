// Pairs of triangles that wait to be decided together.
#pragma once

#include <utility>

#include "collision/pair.h"
#include "geometry/intersection.h"
#include "geometry/triangle_pair.h"

namespace standoff::collision {

class PairBatch {
 public:
  PairBatch(const Pair& pair, const Kernels& kernels)
      : pair_(pair), kernels_(kernels), place_p_(place_of(pair.field.pose)), place_q_(place_of(pair.tree.pose)) {}

  bool full() const { return count_ == kPairs; }

  /// Adds a pair by its places in the field's and the tree's tree. Requires room.
  void add(std::uint32_t field_place, std::uint32_t tree_place) {
    const auto put = [this](double(&to)[3][3][kPairs], const Corners& corners) {
      for (int k = 0; k < 3; ++k)
        to[k][0][count_] = corners[k].x, to[k][1][count_] = corners[k].y, to[k][2][count_] = corners[k].z;
    };
    put(pairs_.p, pair_.field.body->corners[field_place]);
    put(pairs_.q, pair_.tree.body->corners[tree_place]);
    field_[count_] = field_place, tree_[count_] = tree_place;
    ++count_;
  }

  /// Decides what waits, in the order it came, and calls use(field place, tree place, whether they touch, where), until
  /// it returns false. False when it did; nothing waits afterwards. `where()` gives the Overlap of those that touch.
  template <class Use>
  bool settle(Use use) {
    Meetings met;
    const int count = take(kernels_.meet, met);
    const auto is = [](std::uint32_t bits, int n) { return (bits >> n & 1) != 0; };
    for (int n = 0; n < count; ++n) {
      const auto p = [&] { return pair_.field.world(field_[n]); };
      const auto q = [&] { return pair_.tree.world(tree_[n]); };
      const auto where = [&]() -> Overlap {
        if (is(met.unsure | met.inaccurate, n)) return overlap(p(), q());
        return {{met.point[0][n], met.point[1][n], met.point[2][n]},
                {met.normal[0][n], met.normal[1][n], met.normal[2][n]},
                met.depth[n]};
      };
      const bool touch = is(met.touching, n) || (is(met.unsure, n) && triangles_touch(p(), q()));
      if (!use(field_[n], tree_[n], touch, where)) return false;
    }
    return true;
  }

  /// Measures what waits, pairs that do not cross, and calls use(field place, tree place, squared distance, point of
  /// the field's triangle, point of the tree's).
  template <class Use>
  void measure(Use use) {
    ClosestOfPairs found;
    const int count = take(kernels_.closest, found);
    for (int n = 0; n < count; ++n)
      use(field_[n], tree_[n], found.distance_sq[n], Vec3{found.on_p[0][n], found.on_p[1][n], found.on_p[2][n]},
          Vec3{found.on_q[0][n], found.on_q[1][n], found.on_q[2][n]});
  }

 private:
  // Runs a kernel on what waits; returns how many pairs that was.
  template <class Kernel, class Result>
  int take(Kernel kernel, Result& result) {
    if (count_ == 0) return 0;
    for (int n = count_; n < kPairs; ++n)
      for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis)
          pairs_.p[k][axis][n] = pairs_.p[k][axis][0], pairs_.q[k][axis][n] = pairs_.q[k][axis][0];
    kernel(pairs_, pair_.field.moved ? &place_p_ : nullptr, pair_.tree.moved ? &place_q_ : nullptr, result);
    return std::exchange(count_, 0);
  }

  const Pair& pair_;
  const Kernels& kernels_;
  const DoublePlace place_p_, place_q_;
  TrianglePairs pairs_;
  std::uint32_t field_[kPairs], tree_[kPairs];
  int count_ = 0;
};

}  // namespace standoff::collision
