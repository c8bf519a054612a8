// SPDX-License-Identifier: Apache-2.0
// The sides of one tile's samples where caps are near, or the winding number is near a threshold.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sign/inside_rows.h"
#include "sign/open_winding/cap_sum.h"
#include "sign/open_winding/cells.h"
#include "sign/open_winding/node_stack.h"
#include "sign/open_winding/quick_angles.h"
#include "sign/open_winding/row_windings.h"
#include "standoff/sign.h"

namespace standoff {

/// How near to a threshold winding numbers are doubtful, and how far those that are counted may be off.
inline constexpr double kDoubt = 0.05, kDoubtError = 0.025;

/// What decides the sides of an open mesh: the caps of its boundary, and the rule.
struct OpenMesh {
  const Grid& grid;
  WindingRule rule;
  const Rims& rims;
  const RimTree& tree;
  const QuickAngles& quick;
};

class TileSides {
 public:
  TileSides(const OpenMesh& mesh, NodeStack& stack) : mesh_(mesh), stack_(stack) {}

  /// Marks the samples of the box, which is a tile or what is in the grid of it. `smooth`: no triangle of the mesh
  /// touches the tile. `far` is the field of all caps but those of `nodes`. Returns how many samples are doubtful.
  std::int64_t decide(const SampleBox& tile, const RowWindings& windings, bool smooth, NodeStack::Part nodes,
                      const LinearField& far, std::span<std::uint8_t, InsideRows::kRows> inside);

 private:
  void visit(const SampleBox& box, NodeStack::Part nodes, LinearField far, double tolerance);
  void split(const SampleBox& box, NodeStack::Part nodes, const LinearField& far, double tolerance);
  bool decide_by_fields(const SampleBox& box, const Cell& cell, NodeStack::Part& near, LinearField& far,
                        double tolerance);
  void decide_by_field(const SampleBox& box, const Cell& cell, const LinearField& field, bool with_windings);
  void decide_by_winding(const SampleBox& box, double value, double reach, bool with_windings);
  void decide_one_by_one(const SampleBox& box, NodeStack::Part nodes, const LinearField& far);
  void continue_across_caps(const SampleBox& box, NodeStack::Part nodes, const LinearField& far,
                            LinearField& field) const;
  bool decide_sample(std::size_t row, unsigned x, double winding, double error);
  bool has_more_unknown_than(int few, const SampleBox& box) const;

  // Where a sample's row is in the tile, and its bit there.
  std::size_t row_of(std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>(j - tile_.begin[1] + InsideRows::kSide * (k - tile_.begin[2]));
  }
  unsigned bit_of(std::int64_t i) const { return static_cast<unsigned>(i - tile_.begin[0]); }
  // The samples of the box in one of its rows.
  unsigned bits_of(const SampleBox& box) const {
    return ((1u << (box.end[0] - box.begin[0])) - 1) << bit_of(box.begin[0]);
  }
  // Calls use(i, j, k, row) for each sample of the box that is not decided.
  template <class Use>
  void for_each_unknown(const SampleBox& box, const Use& use) const {
    for (std::int64_t k = box.begin[2]; k < box.end[2]; ++k)
      for (std::int64_t j = box.begin[1]; j < box.end[1]; ++j) {
        const std::size_t row = row_of(j, k);
        for (std::int64_t i = box.begin[0]; i < box.end[0]; ++i)
          if ((unknown_[row] >> bit_of(i) & 1) != 0) use(i, j, k, row);
      }
  }

  const OpenMesh& mesh_;
  NodeStack& stack_;
  SampleBox tile_;
  bool smooth_;
  std::int64_t doubtful_;
  std::array<std::uint8_t, InsideRows::kRows> unknown_;  // samples that are not decided, as in InsideRows
  std::array<std::int32_t, InsideRows::kRows * InsideRows::kSide> windings_;
  std::span<std::uint8_t> inside_;
};

}  // namespace standoff
