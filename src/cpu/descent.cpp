#include "cpu/descent.h"

#include <tbb/parallel_for_each.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "cpu/clusters.h"
#include "cpu/radix_sort.h"
#include "geometry/closest_point.h"

namespace difi::cpu {
namespace {

// A node whose longest side exceeds this share of the cell's is replaced by its children: finer boxes cull better,
// coarser ones are fewer. The value is arbitrary: others were not measured, and no value changes the result.
constexpr float kOpenShare = 0.5f;
// Nodes of triangles wait until they are this many times as large: the kernels cull triangles sixteen at once.
constexpr float kOpenTriangles = 4;

// The cell: bricks [low, high) per axis, a power of two of them on a side, cut by the grid.
struct Cell {
  std::int64_t low[3], high[3];
  std::int64_t side;  // in bricks, before cutting

  std::int64_t bricks() const { return (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]); }
};

// Entries and their boxes, an array per coordinate for the kernels.
class EntryList {
 public:
  std::int64_t size() const { return size_; }
  std::uint32_t entry(std::int64_t n) const { return entry_[n]; }
  ClusterBox box(std::int64_t n) const {
    return {{low_[0][n], low_[1][n], low_[2][n]}, {high_[0][n], high_[1][n], high_[2][n]}};
  }
  void add(std::uint32_t entry, const ClusterBox& box) {
    if (size_ + kLanes >= static_cast<std::int64_t>(entry_.size())) grow();
    entry_[size_] = entry;
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis][size_] = box.low[axis];
      high_[axis][size_] = box.high[axis];
    }
    ++size_;
  }
  /// Keeps the first `count` entries.
  void shorten(std::int64_t count) { size_ = count; }
  BoxArrays arrays() {
    return {{low_[0].data(), low_[1].data(), low_[2].data()},
            {high_[0].data(), high_[1].data(), high_[2].data()},
            entry_.data(),
            size_};
  }

 private:
  // All arrays keep room for a register past the last entry, which the kernels may touch.
  void grow() {
    const std::size_t room = 2 * entry_.size() + 4 * kLanes;
    entry_.resize(room);
    for (auto* sides : {&low_, &high_})
      for (auto& side : *sides) side.resize(room);
  }

  std::int64_t size_ = 0;
  std::array<std::vector<float>, 3> low_, high_;
  std::vector<std::uint32_t> entry_;
};

class Descent {
 public:
  Descent(const Job& job, const Lattice& lattice, const Kernels& kernels,
          const std::function<void(std::int64_t, std::span<const std::uint32_t>)>& use)
      : job_(job), lattice_(lattice), kernels_(kernels), use_(use), clusters_(job, lattice) {}

  void run() {
    EntryList roots;
    for (std::uint32_t entry = clusters_.roots_begin(); entry < clusters_.roots_end(); ++entry)
      roots.add(entry, clusters_.box(entry));
    Cell whole{{0, 0, 0}, {lattice_.bricks[0], lattice_.bricks[1], lattice_.bricks[2]}, 1};
    while (whole.side < *std::max_element(lattice_.bricks, lattice_.bricks + 3)) whole.side *= 2;
    visit(whole, roots);
  }

 private:
  // The samples of a cell: centre and half extents in grid units, relative to the grid's centre.
  CullCell samples_of(const Cell& cell) const {
    CullCell box{};
    for (int axis = 0; axis < 3; ++axis) {
      const double step = lattice_.spacing[axis] * lattice_.scale;
      const double first = static_cast<double>(cell.low[axis] * kBrickSide);
      const double last = static_cast<double>(std::min(cell.high[axis] * kBrickSide, lattice_.size[axis]) - 1);
      const double middle = static_cast<double>(lattice_.size[axis] - 1) / 2;
      box.center[axis] = static_cast<float>(((first + last) / 2 - middle) * step);
      box.half[axis] = static_cast<float>((last - first) / 2 * step) * (1 + 1e-6f) + 1e-6f;
    }
    box.reach = lattice_.thickness;
    return box;
  }

  // Replaces large nodes by their children, down to boxes small against the cell.
  EntryList opened(const EntryList& list, float largest) const {
    EntryList result;
    std::vector<std::uint32_t> pending;
    const auto open_or_add = [&](std::uint32_t entry, const ClusterBox& box) {
      const float longest = std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
      if (!clusters_.is_node(entry)) return result.add(entry, box);
      const bool holds_triangles = !clusters_.is_node(clusters_.first_child(entry));
      if (longest <= (holds_triangles ? kOpenTriangles : 1) * largest) return result.add(entry, box);
      for (std::uint32_t child = clusters_.child_count(entry); child-- > 0;)
        pending.push_back(clusters_.first_child(entry) + child);
    };
    for (std::int64_t n = 0; n < list.size(); ++n) {
      open_or_add(list.entry(n), list.box(n));
      while (!pending.empty()) {
        const std::uint32_t entry = pending.back();
        pending.pop_back();
        open_or_add(entry, clusters_.box(entry));
      }
    }
    return result;
  }

  // A point of the surface near `at`: the closest point of a triangle found by following the nearest boxes down.
  std::array<float, 3> surface_point(std::uint32_t entry, const float (&at)[3]) const {
    while (clusters_.is_node(entry)) {
      std::uint32_t best = clusters_.first_child(entry);
      float least = std::numeric_limits<float>::infinity();
      for (std::uint32_t n = 0; n < clusters_.child_count(entry); ++n) {
        const std::uint32_t child = clusters_.first_child(entry) + n;
        const ClusterBox box = clusters_.box(child);
        float distance_sq = 0;
        for (int axis = 0; axis < 3; ++axis) {
          const float off = std::max({box.low[axis] - at[axis], at[axis] - box.high[axis], 0.0f});
          distance_sq += off * off;
        }
        if (distance_sq < least) {
          least = distance_sq;
          best = child;
        }
      }
      entry = best;
    }
    Triple<double> corner[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3 v = job_.mesh.corner(clusters_.order[entry], k) * lattice_.scale;
      corner[k] = {v.x - clusters_.center[0], v.y - clusters_.center[1], v.z - clusters_.center[2]};
    }
    const auto q = closest_on_triangle(Triple<double>{at[0], at[1], at[2]}, corner[0], corner[1], corner[2]);
    return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)};
  }

  // Drops entries that cannot be nearest to any sample of the cell: first against the surface point nearest to the
  // centre, then, while many are left, against points nearest to the cell's corners.
  void cull(const CullCell& cell, EntryList& list) const {
    constexpr std::int64_t kFew = 64;
    const auto against = [&](const float(&probe)[3]) {
      const std::int64_t nearest = kernels_.nearest_box(list.arrays(), probe);
      const auto q = surface_point(list.entry(nearest), probe);
      list.shorten(kernels_.cull_boxes(list.arrays(), cell, q.data()));
    };
    against(cell.center);
    for (int corner = 0; corner < 8 && list.size() > kFew; ++corner) {
      // Opposite corners in turn, so that two sheets on both sides of the cell are found early.
      const int bits = corner % 2 != 0 ? 7 - corner / 2 : corner / 2;
      float probe[3];
      for (int axis = 0; axis < 3; ++axis)
        probe[axis] = cell.center[axis] + ((bits >> axis & 1) != 0 ? cell.half[axis] : -cell.half[axis]);
      against(probe);
    }
  }

  void visit(const Cell& cell, const EntryList& parent) {
    const CullCell samples = samples_of(cell);
    const float side = 2 * std::max({samples.half[0], samples.half[1], samples.half[2]});
    EntryList list = opened(parent, kOpenShare * side);
    cull(samples, list);
    if (list.size() == 0) {
      job_.progress.advance(cell.bricks());
      return;
    }
    if (cell.side == 1) return give(cell, list);
    std::vector<Cell> children;
    const std::int64_t half = cell.side / 2;
    for (int child = 0; child < 8; ++child) {
      Cell part{{}, {}, half};
      bool some = true;
      for (int axis = 0; axis < 3; ++axis) {
        part.low[axis] = cell.low[axis] + ((child >> axis & 1) != 0 ? half : 0);
        part.high[axis] = std::min(part.low[axis] + half, cell.high[axis]);
        some = some && part.low[axis] < part.high[axis];
      }
      if (some) children.push_back(part);
    }
    tbb::parallel_for_each(children, [&](const Cell& part) { visit(part, list); });
  }

  void give(const Cell& cell, const EntryList& list) {
    std::vector<std::uint32_t> triangles, pending;
    for (std::int64_t n = 0; n < list.size(); ++n) {
      pending.push_back(list.entry(n));
      while (!pending.empty()) {
        const std::uint32_t next = pending.back();
        pending.pop_back();
        if (clusters_.is_node(next))
          for (std::uint32_t child = clusters_.child_count(next); child-- > 0;)
            pending.push_back(clusters_.first_child(next) + child);
        else
          triangles.push_back(clusters_.order[next]);
      }
    }
    use_(cell.low[0] + lattice_.bricks[0] * (cell.low[1] + lattice_.bricks[1] * cell.low[2]), triangles);
    job_.progress.advance();
  }

  const Job& job_;
  const Lattice& lattice_;
  const Kernels& kernels_;
  const std::function<void(std::int64_t, std::span<const std::uint32_t>)>& use_;
  const Clusters clusters_;
};

}  // namespace

void for_each_brick_by_descent(const Job& job, const Lattice& lattice, const Kernels& kernels,
                               const std::function<void(std::int64_t, std::span<const std::uint32_t>)>& use) {
  Descent(job, lattice, kernels, use).run();
}

std::int64_t descent_scratch_bytes(std::int64_t triangles) {
  constexpr std::int64_t sorting = 2 * sizeof(KeyedIndex), order = sizeof(std::uint32_t), list = 7 * sizeof(float);
  constexpr std::int64_t node = sizeof(ClusterBox) + sizeof(std::uint32_t) + 1;
  return triangles * (sorting + order + list + node / (Clusters::kFanout - 1) + 1);
}

}  // namespace difi::cpu
