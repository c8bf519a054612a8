// SPDX-License-Identifier: Apache-2.0
#include "collision/body/components.h"

#include <numeric>
#include <utility>

#include "core/weld.h"

namespace standoff::collision {
namespace {

// Disjoint sets of numbers. The lowest number of a set stands for it.
class LowestOfSets {
 public:
  explicit LowestOfSets(std::uint32_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t find(std::uint32_t n) {
    while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
    return n;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    if (a > b) std::swap(a, b);
    parent_[b] = a;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

// Triangles between two looks whether anybody wants it to end.
constexpr std::size_t kCheckEvery = std::size_t{1} << 16;

}  // namespace

std::vector<std::uint32_t> first_of_components(MeshView mesh, ProgressMeter& progress) {
  std::vector<std::uint32_t> number(mesh.vertices.size());
  const std::uint32_t count =
      weld([&](std::uint32_t v) { return mesh.vertices[v]; }, number, [&] { progress.check(); });
  LowestOfSets sets(count);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kCheckEvery == 0) progress.check();
    const Triangle corners = mesh.triangles[t];
    sets.unite(number[corners[0]], number[corners[1]]);
    sets.unite(number[corners[0]], number[corners[2]]);
  }
  std::vector<bool> seen(count);
  std::vector<std::uint32_t> firsts;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kCheckEvery == 0) progress.check();
    const std::uint32_t component = sets.find(number[mesh.triangles[t][0]]);
    if (seen[component]) continue;
    seen[component] = true;
    firsts.push_back(static_cast<std::uint32_t>(t));
  }
  firsts.shrink_to_fit();  // models keep it
  return firsts;
}

}  // namespace standoff::collision
