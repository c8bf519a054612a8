// SPDX-License-Identifier: Apache-2.0
#include "points/open_sides.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/threads.h"
#include "points/known_windings.h"
#include "sign/signs.h"

namespace standoff {
namespace {

// A cell's function must say the winding number but for so much: two of them together, less than half.
constexpr double kUsable = 0.2;
// Fewer points are decided one by one.
constexpr std::size_t kFewCells = 4;

}  // namespace

// The points of one call. Those that are decided together, in a cell, are the numbers in `some`.
class OpenSides::Points {
 public:
  // What the points of one call after the other take.
  struct Memory {
    std::vector<std::uint32_t> some, high;
    std::vector<std::int32_t> windings;
  };

  Points(const OpenSides& sides, std::span<const PointToSide> points, const cpu::PointKernels& kernels,
         WorkCheck& check, std::span<bool> inside, Memory& memory)
      : winding_(sides.winding_),
        rule_(sides.rule_),
        points_(points),
        kernels_(kernels),
        check_(check),
        inside_(inside),
        memory_(memory) {}

  using Some = std::span<std::uint32_t>;

  void decide_all() {
    memory_.windings.resize(points_.size());
    memory_.some.resize(points_.size());
    std::iota(memory_.some.begin(), memory_.some.end(), 0u);
    decide(memory_.some);
  }

 private:
  // In cells that the boundary is far enough from.
  void decide(Some some) {
    if (some.size() < kFewCells) {
      for (const std::uint32_t n : some) inside_[n] = winding_.side(points_[n].at, rule_, kernels_, check_);
      return;
    }
    const Cell cell = cell_around(some);
    const LinearField field = winding_.field(cell, kFieldTolerance, kUsable, check_);
    if (!(field.error <= kUsable)) {
      const auto [low, high] = halves(some, cell);
      decide(low);
      return decide(high);
    }
    count(some, field.center);
    decide_by(field, some);
  }

  // The whole numbers in a cell without boundary: they continue that of the center, where they are those of mesh and
  // caps. All rows between points of the cell are in it.
  void count(Some some, const Vec3& center) {
    KnownWindings known(winding_.mesh(), kernels_);
    known.in_ball(center, 0, [&](const Vec3& at) { return winding_.closed(at, kernels_); });
    for (const std::uint32_t n : some) {
      const auto by_rows = [&](const Vec3& at) { return known.by_rows(at); };
      memory_.windings[n] = known.in_ball(points_[n].at, points_[n].free_radius,
                                          [&](const Vec3& at) { return known.on_row(at, by_rows); });
    }
  }

  // Of those whose whole numbers are known, as the function continues them.
  void decide_by(const LinearField& field, Some some) {
    std::size_t undecided = 0;
    for (const std::uint32_t n : some) {
      const double winding = memory_.windings[n] + field.at(points_[n].at);
      inside_[n] = is_inside(winding, rule_);
      if (!(margin(winding, rule_) > field.error + kWindingRounding)) some[undecided++] = n;
    }
    refine(field, some.first(undecided));
  }

  // Those that the function of a cell left undecided, by those of its parts.
  void refine(const LinearField& coarse, Some some) {
    if (some.empty()) return;
    const auto [low, high] = halves(some, cell_around(some));
    decide_part(coarse, low);
    decide_part(coarse, high);
  }

  void decide_part(const LinearField& coarse, Some some) {
    if (some.size() < kFewCells) {
      for (const std::uint32_t n : some) {
        const Vec3& at = points_[n].at;
        inside_[n] = winding_.side(at, rule_, {memory_.windings[n] + coarse.at(at), coarse.error}, check_);
      }
      return;
    }
    const Cell cell = cell_around(some);
    const LinearField field = winding_.field(cell, std::min(kFieldTolerance, coarse.error / 64), coarse.error, check_);
    if (!(field.error <= coarse.error)) return refine(coarse, some);
    // Both are the same winding number but for a whole one.
    const auto between = static_cast<std::int32_t>(std::round(coarse.at(cell.center) - field.value));
    for (const std::uint32_t n : some) memory_.windings[n] += between;
    decide_by(field, some);
  }

  Cell cell_around(Some some) const {
    Box box;
    for (const std::uint32_t n : some) box.include(points_[n].at);
    const double rounding = 1e-15 * std::max(max_norm(box.min), max_norm(box.max));
    const Vec3 half = box.extent() * 0.5 + Vec3{rounding, rounding, rounding};
    return {box.min + box.extent() * 0.5, half, length(half)};
  }

  struct Halves {
    Some low, high;
  };
  // Cut across the longest side of their cell, their order kept.
  Halves halves(Some some, const Cell& cell) const {
    const Vec3& e = cell.half;
    double Vec3::*const axis = e.x >= e.y && e.x >= e.z ? &Vec3::x : e.y >= e.z ? &Vec3::y : &Vec3::z;
    memory_.high.clear();
    std::size_t count = 0;
    for (const std::uint32_t n : some)
      if (points_[n].at.*axis < cell.center.*axis)
        some[count++] = n;
      else
        memory_.high.push_back(n);
    std::ranges::copy(memory_.high, some.begin() + static_cast<std::ptrdiff_t>(count));
    if (count == 0 || count == some.size()) count = some.size() / 2;  // all in one place
    return {some.first(count), some.subspan(count)};
  }

  const OpenPointWinding& winding_;
  const WindingRule rule_;
  const std::span<const PointToSide> points_;
  const cpu::PointKernels& kernels_;
  WorkCheck& check_;
  const std::span<bool> inside_;
  Memory& memory_;
};

void OpenSides::decide(std::span<const PointToSide> points, const cpu::PointKernels& kernels, WorkCheck& check,
                       std::span<bool> inside) const {
  const KeptByThread<Points::Memory> memory;
  Points(*this, points, kernels, check, inside, *memory).decide_all();
}

}  // namespace standoff
