// SPDX-License-Identifier: Apache-2.0
#include "tests/grammar/placed.h"

#include <algorithm>
#include <cmath>

namespace standoff::grammar {

void add_placed(const Truth& part, const Transform& to, Mirrored mirrored, Truth& all) {
  double most = 0, slack = 0;
  for (const Corners& corners : part.triangles)
    for (const Vec3& p : corners) most = std::max({most, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  for (const double s : part.slack) slack = std::max(slack, s);
  const std::size_t second = mirrored == Mirrored::turned_back && to.mirrors() ? 2 : 1;
  for (const Corners& corners : part.triangles)
    all.triangles.push_back({to(corners[0]), to(corners[second]), to(corners[3 - second])});
  all.slack.resize(all.triangles.size(), to.slack(most, slack));
}

}  // namespace standoff::grammar
