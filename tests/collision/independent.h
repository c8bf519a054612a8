// SPDX-License-Identifier: Apache-2.0
// Answers about bodies by another method than standoff's, for long checks: a binary tree of boxes, and separating axes
// of triangles (standoff's exact test takes signs of determinants at edges), first in double with a bound of its
// rounding, then in integers. Triangles must have an area.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "standoff/mesh.h"
#include "standoff/pose.h"
#include "tests/collision/exact_sign.h"

namespace standoff::testing {

using Wider = long double;
template <class T>
using Triple = std::array<T, 3>;
template <class T>
using ThreeCorners = std::array<Triple<T>, 3>;

template <class T>
Triple<T> operator-(const Triple<T>& a, const Triple<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
Triple<T> crossed(const Triple<T>& a, const Triple<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T>
T dotted(const Triple<T>& a, const Triple<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class T>
struct Shadow {
  T low, high;
};
template <class T, class Points>
Shadow<T> shadow(const Triple<T>& axis, const Points& points) {
  Shadow<T> it{dotted(axis, points[0]), dotted(axis, points[0])};
  for (const Triple<T>& p : points) {
    const T at = dotted(axis, p);
    if (at < it.low) it.low = at;
    if (it.high < at) it.high = at;
  }
  return it;
}

/// The axes to test: if two triangles with an area are apart, one of these separates them. They are the facets of their
/// difference, and axes in the plane if both lie in one.
template <class T, class Use>
bool any_axis(const ThreeCorners<T>& p, const ThreeCorners<T>& q, bool in_plane, Use use) {
  const Triple<T> e[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]}, f[3] = {q[1] - q[0], q[2] - q[1], q[0] - q[2]};
  const Triple<T> n = crossed(e[0], e[1]), m = crossed(f[0], f[1]);
  if (use(n) || use(m)) return true;
  for (const auto& a : e)
    for (const auto& b : f)
      if (use(crossed(a, b))) return true;
  if (!in_plane) return false;
  for (int k = 0; k < 3; ++k)
    if (use(crossed(n, e[k])) || use(crossed(m, f[k]))) return true;
  return false;
}

inline bool touch_exactly(const std::array<Vec3, 3>& p, const std::array<Vec3, 3>& q) {
  int exponent = 1 << 20;
  for (const auto* t : {&p, &q})
    for (const Vec3& v : *t)
      for (const double x : {v.x, v.y, v.z}) exponent = std::min(exponent, lowest_exponent(x));
  const auto whole = [&](const std::array<Vec3, 3>& t) {
    ThreeCorners<Whole> w;
    for (int k = 0; k < 3; ++k) w[k] = {scaled(t[k].x, exponent), scaled(t[k].y, exponent), scaled(t[k].z, exponent)};
    return w;
  };
  const ThreeCorners<Whole> a = whole(p), b = whole(q);
  return !any_axis(a, b, true, [&](const Triple<Whole>& axis) {
    const auto s = shadow(axis, a), t = shadow(axis, b);
    return s.high < t.low || t.high < s.low;
  });
}

/// Coordinates relative to a point nearby.
template <class T>
ThreeCorners<T> seen_from(const Vec3& at, const std::array<Vec3, 3>& t) {
  ThreeCorners<T> w;
  for (int k = 0; k < 3; ++k) w[k] = {T(t[k].x) - T(at.x), T(t[k].y) - T(at.y), T(t[k].z) - T(at.z)};
  return w;
}

/// Whether the triangles have a point in common, exactly.
inline bool independent_touch(const std::array<Vec3, 3>& p, const std::array<Vec3, 3>& q) {
  const ThreeCorners<double> a = seen_from<double>(q[0], p), b = seen_from<double>(q[0], q);
  double most = 0;
  for (const auto* t : {&a, &b})
    for (const auto& v : *t)
      for (const double x : v) most = std::max(most, std::abs(x));
  // A projection is a sum of three products of an axis (|component| <= 8 most^2, with an error of 32 u most^2) and a
  // corner: its error is less than 512 u most^3, u = epsilon / 2. Edges here are differences of rounded ones, which
  // four times that covers.
  const double off = 4 * 1024 * (std::numeric_limits<double>::epsilon() / 2) * most * most * most;
  bool sure = true;
  const bool apart = any_axis(a, b, false, [&](const Triple<double>& axis) {
    const auto s = shadow(axis, a), t = shadow(axis, b);
    const double gap = std::max(t.low - s.high, s.low - t.high);
    sure = sure && gap < -off;
    return gap > off;
  });
  // If both lie in one plane, the axes above are too few; but then the gap along its normal is zero, so never sure.
  return apart ? false : sure ? true : touch_exactly(p, q);
}

/// Whether some axis shows that a triangle that moves straight by `translation` stays out of a resting one, or enters
/// it by at most `deep`. Axes shorter than `least` times the product of their edges have no direction, and are left
/// out.
template <class T>
bool stays_out(const std::array<Vec3, 3>& moving, Vec3 translation, const std::array<Vec3, 3>& resting, double deep,
               T least) {
  const ThreeCorners<T> p = seen_from<T>(resting[0], moving), q = seen_from<T>(resting[0], resting);
  const Triple<T> v{T(translation.x), T(translation.y), T(translation.z)};
  std::array<Triple<T>, 6> prism;
  for (int k = 0; k < 3; ++k) prism[k] = p[k], prism[k + 3] = {p[k][0] + v[0], p[k][1] + v[1], p[k][2] + v[2]};
  const auto shows = [&](const Triple<T>& u, const Triple<T>& w) {
    const Triple<T> axis = crossed(u, w);
    const T length_sq = dotted(axis, axis);
    if (!(length_sq > least * least * dotted(u, u) * dotted(w, w))) return false;
    const auto s = shadow(axis, prism), t = shadow(axis, q);
    return std::max(t.low - s.high, s.low - t.high) >= -T(deep) * std::sqrt(length_sq);
  };
  const Triple<T> e[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]}, f[3] = {q[1] - q[0], q[2] - q[1], q[0] - q[2]};
  if (shows(e[0], e[1]) || shows(f[0], f[1])) return true;
  for (int k = 0; k < 3; ++k)
    if (shows(e[k], v) || shows(v, f[k])) return true;
  for (const auto& a : e)
    for (const auto& b : f)
      if (shows(a, b)) return true;
  return false;
}

/// The same in double, and if it cannot decide, in long double. The error of directions is epsilon / `least`.
inline bool stays_out(const std::array<Vec3, 3>& moving, Vec3 translation, const std::array<Vec3, 3>& resting,
                      double deep) {
  return stays_out<double>(moving, translation, resting, deep, 1e-5) ||
         stays_out<Wider>(moving, translation, resting, deep, Wider(1e-8));
}

/// The least distance of two triangles that do not touch: the least of corners from triangles and of edges from edges.
inline double gap_of(const std::array<Vec3, 3>& p, const std::array<Vec3, 3>& q) {
  using Point = Triple<Wider>;
  const ThreeCorners<Wider> a = seen_from<Wider>(q[0], p), b = seen_from<Wider>(q[0], q);
  const auto along = [](const Point& from, const Point& step, Wider t) {
    return Point{from[0] + step[0] * t, from[1] + step[1] * t, from[2] + step[2] * t};
  };
  const auto unit = [](Wider t) { return std::clamp(t, Wider(0), Wider(1)); };
  Wider least = std::numeric_limits<Wider>::infinity();
  const auto take = [&](const Point& x, const Point& y) { least = std::min(least, dotted(x - y, x - y)); };
  const auto point_and_edge = [&](const Point& x, const Point& from, const Point& to) {
    const Point step = to - from;
    take(x, along(from, step, unit(dotted(x - from, step) / dotted(step, step))));
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Point &u = a[i], &v = a[(i + 1) % 3], &x = b[j], &y = b[(j + 1) % 3];
      point_and_edge(u, x, y);
      point_and_edge(x, u, v);
      // Take the lines' closest points if both are inside their edges.
      const Point d = v - u, e = y - x, r = u - x;
      const Wider dd = dotted(d, d), ee = dotted(e, e), de = dotted(d, e), det = dd * ee - de * de;
      if (!(det > 1e-18L * dd * ee)) continue;
      const Wider s = (de * dotted(e, r) - ee * dotted(d, r)) / det, t = (dd * dotted(e, r) - de * dotted(d, r)) / det;
      if (s >= 0 && s <= 1 && t >= 0 && t <= 1) take(along(u, d, s), along(x, e, t));
    }
  const auto point_over_face = [&](const Point& x, const ThreeCorners<Wider>& t) {
    const Point n = crossed(t[1] - t[0], t[2] - t[0]);
    for (int k = 0; k < 3; ++k)
      if (dotted(crossed(t[(k + 1) % 3] - t[k], x - t[k]), n) < 0) return;
    const Wider off = dotted(x - t[0], n);
    least = std::min(least, off * off / dotted(n, n));
  };
  for (int k = 0; k < 3; ++k) point_over_face(a[k], b), point_over_face(b[k], a);
  return static_cast<double>(std::sqrt(least));
}

/// Triangles in the world under a binary tree of boxes.
class IndependentBody {
 public:
  explicit IndependentBody(const Mesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    split(0, order_.size());
    place({});
  }

  void place(const Pose& pose) {
    const auto& r = pose.rotation;
    vertices_.clear();
    for (const Vec3& v : mesh_.vertices) {
      const auto row = [&](int i, double t) { return ((r[i] * v.x + r[i + 1] * v.y) + r[i + 2] * v.z) + t; };
      vertices_.push_back({row(0, pose.translation.x), row(3, pose.translation.y), row(6, pose.translation.z)});
    }
    fit_boxes();
  }

  std::array<Vec3, 3> triangle(std::uint32_t t) const {
    const Triangle& it = mesh_.triangles[t];
    return {vertices_[it[0]], vertices_[it[1]], vertices_[it[2]]};
  }

  bool touches(const IndependentBody& other) const {
    return any_pair(other, {}, 0, 0, [&](std::uint32_t s, std::uint32_t t) {
      return independent_touch(triangle(s), other.triangle(t));
    });
  }

  /// Whether it passes through the other one by more than `deep`, on a straight path by `translation`.
  bool passes_through(const IndependentBody& other, Vec3 translation, double deep) {
    // Cut the path into parts, because boxes of long translations hold many triangles.
    const int parts = 1 + static_cast<int>(length(translation));
    const std::vector<Vec3> from = vertices_;
    bool passes = false;
    for (int n = 0; n < parts && !passes; ++n) {
      passes = any_pair(other, translation * (1.0 / parts), 0, 0, [&](std::uint32_t s, std::uint32_t t) {
        return !stays_out(triangle(s), translation * (1.0 / parts), other.triangle(t), deep);
      });
      for (std::size_t v = 0; v < from.size(); ++v) vertices_[v] = from[v] + translation * ((n + 1.0) / parts);
      fit_boxes();
    }
    return passes;
  }

 private:
  struct Node {
    Box box;
    std::size_t begin, end, right;  // right: 0 for a leaf; the left child is the next node
  };
  void fit_boxes() {
    for (std::size_t n = nodes_.size(); n-- > 0;) {
      Node& node = nodes_[n];
      node.box = {};
      if (node.right != 0)
        node.box = both(nodes_[n + 1].box, nodes_[node.right].box);
      else
        for (std::size_t k = node.begin; k < node.end; ++k)
          for (const Vec3& v : triangle(order_[k])) node.box = both(node.box, {v, v});
    }
  }

  static Box both(const Box& a, const Box& b) { return {min(a.min, b.min), max(a.max, b.max)}; }

  std::size_t split(std::size_t begin, std::size_t end) {
    const std::size_t n = nodes_.size();
    nodes_.push_back({{}, begin, end, 0});
    if (end - begin <= 4) return n;
    const auto center = [&](std::uint32_t t, int axis) {
      double sum = 0;
      for (const auto v : mesh_.triangles[t])
        sum += axis == 0 ? mesh_.vertices[v].x : axis == 1 ? mesh_.vertices[v].y : mesh_.vertices[v].z;
      return sum;
    };
    int axis = 0;
    double widest = -1;
    for (int a = 0; a < 3; ++a) {
      double low = 1e300, high = -1e300;
      for (std::size_t k = begin; k < end; ++k)
        low = std::min(low, center(order_[k], a)), high = std::max(high, center(order_[k], a));
      if (high - low > widest) widest = high - low, axis = a;
    }
    const std::size_t middle = (begin + end) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) { return center(a, axis) < center(b, axis); });
    split(begin, middle);
    const std::size_t right = split(middle, end);
    nodes_[n].right = right;
    return n;
  }

  Box box_of(std::uint32_t t) const {
    const auto [a, b, c] = triangle(t);
    return {min(min(a, b), c), max(max(a, b), c)};
  }
  static bool meet(const Box& a, Vec3 translation, const Box& b) {
    const Vec3 none{}, low = a.min + min(translation, none), high = a.max + max(translation, none);
    return low.x <= b.max.x && low.y <= b.max.y && low.z <= b.max.z && high.x >= b.min.x && high.y >= b.min.y &&
           high.z >= b.min.z;
  }

  template <class Test>
  bool any_pair(const IndependentBody& other, Vec3 translation, std::size_t mine, std::size_t theirs,
                const Test& test) const {
    const Node &a = nodes_[mine], &b = other.nodes_[theirs];
    if (!meet(a.box, translation, b.box)) return false;
    if (a.right == 0 && b.right == 0) {
      for (std::size_t s = a.begin; s < a.end; ++s)
        for (std::size_t t = b.begin; t < b.end; ++t)
          if (meet(box_of(order_[s]), translation, other.box_of(other.order_[t])) && test(order_[s], other.order_[t]))
            return true;
      return false;
    }
    if (b.right == 0 || (a.right != 0 && a.end - a.begin > b.end - b.begin))
      return any_pair(other, translation, mine + 1, theirs, test) ||
             any_pair(other, translation, a.right, theirs, test);
    return any_pair(other, translation, mine, theirs + 1, test) || any_pair(other, translation, mine, b.right, test);
  }

  const Mesh& mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
  std::vector<Vec3> vertices_;
};

}  // namespace standoff::testing
