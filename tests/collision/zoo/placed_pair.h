// SPDX-License-Identifier: Apache-2.0
// Two placed bodies, with all that is true of them.
#pragma once

#include <optional>

#include "standoff/collision.h"
#include "tests/collision/zoo/tolerances.h"

namespace standoff::testing {

struct PlacedPair {
  const Body &model_a, &model_b;
  Pose pose_a, pose_b;
  PlacedBody a, b;
  TrianglePairs touching;
  Allowed allowed;  ///< of both bodies

  PlacedPair(const Body& of_a, const Pose& at_a, const Body& of_b, const Pose& at_b)
      : model_a(of_a),
        model_b(of_b),
        pose_a(at_a),
        pose_b(at_b),
        a(of_a.mesh(), at_a),
        b(of_b.mesh(), at_b),
        touching(touching_pairs(a, b)),
        allowed(box_around(a.box(), b.box())) {}

  bool touch() const { return !touching.empty(); }

  /// The least distance of all pairs of triangles.
  double distance() const {
    if (!distance_) distance_ = touch() ? 0 : least_gap();
    return *distance_;
  }

 private:
  static Box box_around(Box box, const Box& other) {
    box.include(other.min), box.include(other.max);
    return box;
  }
  double least_gap() const {
    // Those whose boxes are near first: most others need not be measured.
    struct Candidate {
      double least;
      std::uint32_t s, t;
    };
    std::vector<Candidate> all;
    for (std::uint32_t s = 0; s < a.size(); ++s)
      for (std::uint32_t t = 0; t < b.size(); ++t) {
        const Vec3 none{}, out = max(max(a.box(s).min - b.box(t).max, b.box(t).min - a.box(s).max), none);
        all.push_back({length(out) * (1 - 1e-14), s, t});
      }
    std::sort(all.begin(), all.end(), [](const Candidate& x, const Candidate& y) { return x.least < y.least; });
    double least = std::numeric_limits<double>::infinity();
    for (const Candidate& it : all) {
      if (it.least > least) break;
      least = std::min(least, root_of(gap_of_free_sq(a.triangle(it.s), b.triangle(it.t))));
    }
    return least;
  }
  mutable std::optional<double> distance_;
};

}  // namespace standoff::testing
