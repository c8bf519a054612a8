// SPDX-License-Identifier: Apache-2.0
#include "scenes/size.h"

#include <algorithm>
#include <limits>

namespace standoff::scenes {
namespace {

double length_sq(Vec3 v) { return dot(v, v); }

double edge_sq(const Mesh& mesh, std::size_t t, int e) {
  const auto& c = mesh.triangles[t];
  return length_sq(mesh.vertices[c[e]] - mesh.vertices[c[(e + 1) % 3]]);
}

double longest_sq(const Mesh& mesh, std::size_t t) {
  return std::max({edge_sq(mesh, t, 0), edge_sq(mesh, t, 1), edge_sq(mesh, t, 2)});
}

// One side of a triangle. Sides of the same edge have equal ends and, computed from them in order, equal lengths.
struct Side {
  double length_sq;
  std::uint32_t low, high;  // vertices
  std::uint32_t triangle;
  int side;
};

bool same_edge(const Side& a, const Side& b) { return a.low == b.low && a.high == b.high; }

// All sides at least as long as the longest sides of about `wanted` triangles, longest first, grouped by edge. Every
// triangle at such an edge is among those looked at, so a group is complete.
std::vector<Side> long_sides(const Mesh& mesh, std::size_t wanted) {
  const std::size_t n = mesh.triangles.size();
  std::vector<double> longest(n);
  for (std::size_t t = 0; t < n; ++t) longest[t] = longest_sq(mesh, t);
  double threshold = 0;
  if (wanted < n) {
    auto ranked = longest;
    std::nth_element(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(wanted), ranked.end(),
                     std::greater<double>());
    threshold = ranked[wanted];
  }
  std::vector<Side> sides;
  for (std::size_t t = 0; t < n; ++t) {
    if (longest[t] < threshold) continue;
    for (int e = 0; e < 3; ++e) {
      const auto [low, high] = std::minmax(mesh.triangles[t][e], mesh.triangles[t][(e + 1) % 3]);
      const double sq = length_sq(mesh.vertices[low] - mesh.vertices[high]);
      if (sq >= threshold && low != high) sides.push_back({sq, low, high, static_cast<std::uint32_t>(t), e});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    if (a.length_sq != b.length_sq) return a.length_sq > b.length_sq;
    if (a.low != b.low) return a.low < b.low;
    if (a.high != b.high) return a.high < b.high;
    return a.triangle < b.triangle;
  });
  return sides;
}

// Splits edges that share no triangle, longest first, adding at most `missing` triangles. Returns how many it added.
std::int64_t split_pass(Mesh& mesh, std::int64_t missing, std::size_t wanted) {
  struct Cut {
    int side = -1;
    std::uint32_t middle = 0;
  };
  std::vector<Cut> cuts(mesh.triangles.size());
  const auto sides = long_sides(mesh, wanted);
  std::int64_t added = 0;
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    bool free = true;
    for (end = i; end < sides.size() && same_edge(sides[i], sides[end]); ++end)
      free = free && cuts[sides[end].triangle].side < 0;
    const auto group = static_cast<std::int64_t>(end - i);
    if (!free || added + group > missing) continue;
    const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back((mesh.vertices[sides[i].low] + mesh.vertices[sides[i].high]) * 0.5);
    for (std::size_t k = i; k < end; ++k) cuts[sides[k].triangle] = {sides[k].side, middle};
    added += group;
  }
  std::vector<Triangle> result;
  result.reserve(mesh.triangles.size() + static_cast<std::size_t>(added));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle whole = mesh.triangles[t];
    if (cuts[t].side < 0) {
      result.push_back(whole);
      continue;
    }
    const int from = cuts[t].side, to = (from + 1) % 3;
    Triangle first = whole, second = whole;
    first[to] = cuts[t].middle;
    second[from] = cuts[t].middle;
    result.push_back(first);
    result.push_back(second);
  }
  mesh.triangles = std::move(result);
  return added;
}

}  // namespace

double edge_for(Draw draw, std::int64_t triangles, double guess, double slender) {
  const auto count = [&](double edge) {
    Builder b(edge, true, slender);
    draw(b);
    return b.triangle_count();
  };
  // Counts fall as the edge grows, with small steps back: bracket, bisect, and keep the best that was seen.
  double best = 0, coarsest = guess;
  std::int64_t best_count = 0, fewest = std::numeric_limits<std::int64_t>::max();
  const auto fits = [&](double edge) {
    const std::int64_t n = count(edge);
    if (n > 0 && n < fewest) {
      coarsest = edge;
      fewest = n;
    }
    if (n <= triangles && n > best_count) {
      best = edge;
      best_count = n;
    }
    return n <= triangles;
  };
  const auto near_enough = [&] { return best_count >= triangles - triangles / 200; };
  double fine = guess, coarse = guess;
  if (fits(guess)) {
    for (int i = 0; i < 40 && !near_enough() && fits(fine *= 0.7); ++i) coarse = fine;
  } else {
    for (int i = 0; i < 40 && !fits(coarse *= 1.4); ++i) fine = coarse;
  }
  for (int i = 0; i < 24 && !near_enough(); ++i) {
    const double middle = 0.5 * (fine + coarse);
    (fits(middle) ? coarse : fine) = middle;
  }
  return best_count > 0 ? best : coarsest;
}

void split_to(Mesh& mesh, std::int64_t triangles) {
  std::int64_t missing = triangles - static_cast<std::int64_t>(mesh.triangles.size());
  std::size_t wanted = static_cast<std::size_t>(std::max<std::int64_t>(missing, 0)) * 2 + 64;
  while (missing > 0) {
    const std::int64_t added = split_pass(mesh, missing, wanted);
    missing -= added;
    if (added > 0) continue;
    if (wanted >= mesh.triangles.size()) return;  // all edges were looked at: no edge has few enough triangles
    wanted = std::numeric_limits<std::size_t>::max();
  }
}

}  // namespace standoff::scenes
