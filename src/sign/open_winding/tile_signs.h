// SPDX-License-Identifier: Apache-2.0
// The signs of one tile's samples where caps are near, or the winding number is near a threshold.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sign/open_winding/cap_tree.h"
#include "sign/open_winding/quick_angles.h"
#include "sign/rows/row_crossings.h"
#include "sign/signs.h"
#include "standoff/sign.h"

namespace standoff {

/// Samples of a row from `from` on, up to the next run, have this winding number.
struct WindingRun {
  std::int64_t from;
  std::int32_t winding;
};

/// The integer winding number along the rows of one row of tiles, of two meshes together.
class RowWindings {
 public:
  /// Takes the crossings of both meshes, each sorted.
  RowWindings(std::span<const RowCrossing> a, std::span<const RowCrossing> b);

  /// The runs of a row; the first one begins at 0.
  std::span<const WindingRun> of_row(int row) const {
    const auto n = static_cast<std::size_t>(row);
    return std::span(runs_).subspan(begin_[n], begin_[n + 1] - begin_[n]);
  }
  /// Calls use(from, to, winding) for the runs among the samples begin to end - 1 of a row.
  template <class Use>
  void for_each(int row, std::int64_t begin, std::int64_t end, const Use& use) const {
    const std::span<const WindingRun> runs = of_row(row);
    for (std::size_t n = 0; n < runs.size() && runs[n].from < end; ++n) {
      const std::int64_t to = n + 1 < runs.size() ? std::min(runs[n + 1].from, end) : end;
      if (to > begin) use(std::max(runs[n].from, begin), to, runs[n].winding);
    }
  }

 private:
  std::array<std::size_t, InsideRows::kRows + 1> begin_;
  std::vector<WindingRun> runs_;
};

/// Winding numbers are doubtful if their distance from a threshold is less than kDoubt. Those that are counted have an
/// error of at most kDoubtError.
inline constexpr double kDoubt = 0.05, kDoubtError = 0.025;

/// The caps of an open mesh's boundary, and the rule: together with integer winding numbers they decide all sides.
struct OpenMesh {
  const Grid& grid;
  WindingRule rule;
  const Rims& rims;
  const RimTree& tree;
  const QuickAngles& quick;
};

class TileSigns {
 public:
  TileSigns(const OpenMesh& mesh, NodeStack& stack) : mesh_(mesh), stack_(stack), sum_(mesh.quick, stack) {}

  /// Marks the samples of a tile's part within the grid. `smooth`: no triangle of the mesh touches the tile. `far` is
  /// the field of all caps that are not in `nodes`. Returns the number of doubtful samples.
  std::int64_t decide(const SampleBox& tile, const RowWindings& windings, bool smooth, NodeStack::Part nodes,
                      const LinearField& far, std::span<std::uint8_t, InsideRows::kRows> inside);

 private:
  void visit(const SampleBox& box, NodeStack::Part nodes, LinearField far, double tolerance);
  void decide_among_many(const SampleBox& box, NodeStack::Part nodes, LinearField far);
  bool decide_by_fields(const SampleBox& box, const Cell& cell, NodeStack::Part& near, LinearField& far,
                        double tolerance);
  void decide_by_field(const SampleBox& box, const Cell& cell, const LinearField& field, bool with_windings);
  void decide_by_winding(const SampleBox& box, double value, double reach, bool with_windings);
  void decide_one_by_one(const SampleBox& box, NodeStack::Part nodes, const LinearField& far);
  void continue_across_caps(const SampleBox& box, NodeStack::Part nodes, const LinearField& far,
                            LinearField& field) const;
  void decide_by_sums(std::size_t row, unsigned x, const Vec3& p, NodeStack::Part nodes, Interval far);
  bool decide_sample(std::size_t row, unsigned x, const Interval& angles);
  bool decide_sample(std::size_t row, unsigned x, double winding, double error);
  bool has_more_undecided_than(int few, const SampleBox& box) const;

  // The number of a sample's row in the tile, and the sample's bit there.
  std::size_t row_of(std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>(j - tile_.begin[1] + InsideRows::kSide * (k - tile_.begin[2]));
  }
  unsigned bit_of(std::int64_t i) const { return static_cast<unsigned>(i - tile_.begin[0]); }
  // The samples of the box in one of its rows.
  unsigned bits_of(const SampleBox& box) const {
    return ((1u << (box.end[0] - box.begin[0])) - 1) << bit_of(box.begin[0]);
  }
  // Whether the samples of the box are decided one by one.
  static bool is_smallest(const SampleBox& box) { return longest(box) <= 2; }
  static std::int64_t longest(const SampleBox& box) {
    return std::max({box.end[0] - box.begin[0], box.end[1] - box.begin[1], box.end[2] - box.begin[2]});
  }
  // Calls use(part) for eight parts of a tile, or of a part of it; some may have no samples.
  template <class Use>
  static void for_each_part(const SampleBox& box, const Use& use) {
    const std::int64_t half = longest(box) > 4 ? 4 : 2;
    for (int part = 0; part < 8; ++part) {
      SampleBox child = box;
      for (std::size_t axis = 0; axis < 3; ++axis)
        (part >> axis & 1 ? child.begin : child.end)[axis] = std::min(box.begin[axis] + half, box.end[axis]);
      use(child);
    }
  }
  // Calls use(i, j, k, row) for each undecided sample of the box.
  template <class Use>
  void for_each_undecided(const SampleBox& box, const Use& use) const {
    for (std::int64_t k = box.begin[2]; k < box.end[2]; ++k)
      for (std::int64_t j = box.begin[1]; j < box.end[1]; ++j) {
        const std::size_t row = row_of(j, k);
        for (std::int64_t i = box.begin[0]; i < box.end[0]; ++i)
          if ((undecided_[row] >> bit_of(i) & 1) != 0) use(i, j, k, row);
      }
  }

  const OpenMesh& mesh_;
  NodeStack& stack_;
  PointSum sum_;
  SampleBox tile_;
  bool smooth_;
  std::int64_t doubtful_;
  std::array<std::uint8_t, InsideRows::kRows> undecided_;  // samples, as in InsideRows
  std::array<std::int32_t, InsideRows::kRows * InsideRows::kSide> windings_;
  std::span<std::uint8_t> inside_;
};

}  // namespace standoff
