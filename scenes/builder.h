// SPDX-License-Identifier: Apache-2.0
// Collects the triangles of a scene. Everything a scene makes passes through here.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/frame.h"
#include "standoff/mesh.h"

namespace standoff::scenes {

/// Consecutive vertices: a loop, an open row, or one point.
struct Ring {
  std::uint32_t first = 0;
  int count = 0;
  bool closed = true;
};

/// A scene is a function that draws parts into a builder. How finely a part is divided follows from one length, the
/// target edge, so that one scene comes in any size; a builder that only counts finds the edge for a wanted size.
class Builder {
 public:
  /// `paired_share` is the share of parts, 0 to 1, whose two triangles of a quadrilateral follow each other; in the
  /// others all first halves of a row come before the second halves. The thesis's skip rule compares neighbours in mesh
  /// order: this share decides how many triangles it drops.
  /// `slender` is how much longer pieces are along a part than around it, as in meshes made for manufacture.
  Builder(double edge, bool counting, double slender = 1, double paired_share = 0);

  bool counting() const { return counting_; }
  std::int64_t triangle_count() const { return count_; }
  double edge() const { return edge_; }

  /// Pieces to divide a length into (slender ones): rounded, at least `least`.
  int segments(double length, int least = 1) const;
  /// Sides of a circle of this radius: at least `least`, fewer where the whole circle is about as long as an edge.
  int sides(double radius, int least = 8) const;
  /// Whether a solid of this length and width is too small to show at the target edge; solids leave themselves out.
  bool hides(double length, double width) const { return length * width < kSmallest * kSmallest * edge_ * edge_; }

  std::uint32_t vertex(Vec3 p) {
    if (!counting_) mesh_.vertices.push_back(p);
    return next_vertex_++;
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    ++count_;
    if (!counting_) mesh_.triangles.push_back({a, b, c});
  }
  /// Corners in counterclockwise order seen from outside.
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangle(a, b, c);
    second_half({a, c, d});
  }

  Ring point(Vec3 p) { return {vertex(p), 1, true}; }
  /// `position(i)` for i in [0, count).
  template <class F>
  Ring ring(int count, bool closed, F&& position) {
    const Ring r{next_vertex_, count, closed};
    next_vertex_ += static_cast<std::uint32_t>(count);
    if (!counting_)
      for (int i = 0; i < count; ++i) mesh_.vertices.push_back(position(i));
    return r;
  }
  /// Joins two rings of equal count, or a ring and a point. Seen from outside with `b` above `a`, rings run to the
  /// right.
  void stitch(Ring a, Ring b);
  /// Counts triangles without making them; only while counting.
  void count_only(std::int64_t triangles) { count_ += triangles; }
  /// Ends a row of quadrilaterals: writes the second halves if they are many.
  void end_row();
  /// Ends a part. Every part calls it once, last.
  void end_part();

  Mesh take();

  /// While it lives, the target edge is multiplied by a factor.
  class Coarser {
   public:
    Coarser(Builder& builder, double factor) : builder_(builder), before_(builder.edge_) { builder.edge_ *= factor; }
    ~Coarser() { builder_.edge_ = before_; }
    Coarser(const Coarser&) = delete;
    Coarser& operator=(const Coarser&) = delete;

   private:
    Builder& builder_;
    double before_;
  };

 private:
  static constexpr double kSmallest = 0.35;  // of the target edge: the smallest side worth drawing

  void second_half(Triangle t) {
    ++count_;
    if (counting_) return;
    if (paired_) {
      mesh_.triangles.push_back(t);
    } else {
      seconds_.push_back(t);
    }
  }
  void flush();
  void choose_order();

  double edge_;
  bool counting_;
  double slender_;
  double paired_share_;
  bool paired_ = false;
  std::uint64_t part_ = 0;
  std::uint32_t next_vertex_ = 0;
  std::int64_t count_ = 0;
  std::vector<Triangle> seconds_;
  Mesh mesh_;
};

}  // namespace standoff::scenes
