// Triangles in groups of neighbours, groups of groups, and a box around each: what coarse cells look at instead of
// triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "cpu/lattice.h"
#include "field/backend.h"

namespace difi::cpu {

/// A box in float, grid units relative to the centre of the grid, rounded outwards and a little more: `slack` covers
/// what later subtractions in float lose.
struct ClusterBox {
  float low[3], high[3];
};

/// Triangles sorted along a Morton curve; nodes of up to kFanout consecutive triangles, or nodes of the level below.
/// An entry is a position in `order` (below triangles()) or, from there on, a node.
class Clusters {
 public:
  static constexpr int kFanout = 8;

  Clusters(const Job& job, const Lattice& lattice);

  std::uint32_t triangles() const { return static_cast<std::uint32_t>(order.size()); }
  bool is_node(std::uint32_t entry) const { return entry >= triangles(); }
  /// The entries of a node: `child_count` consecutive ones from `first_child` on.
  std::uint32_t first_child(std::uint32_t entry) const { return first_[entry - triangles()]; }
  std::uint32_t child_count(std::uint32_t entry) const { return count_[entry - triangles()]; }
  /// The top: entries [roots_begin, roots_end) hold all triangles.
  std::uint32_t roots_begin() const { return roots_begin_; }
  std::uint32_t roots_end() const { return triangles() + static_cast<std::uint32_t>(boxes_.size()); }
  ClusterBox box(std::uint32_t entry) const {
    return is_node(entry) ? boxes_[entry - triangles()] : triangle_box(order[entry]);
  }

  std::vector<std::uint32_t> order;  ///< mesh indices of the triangles, sorted
  double center[3];                  ///< of the grid, world units times scale

 private:
  ClusterBox triangle_box(std::uint32_t triangle) const;
  void sort();
  void build_nodes();

  const Job& job_;
  const Lattice& lattice_;
  float slack_ = 0;
  std::vector<ClusterBox> boxes_;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint8_t> count_;
  std::uint32_t roots_begin_ = 0;
};

}  // namespace difi::cpu
