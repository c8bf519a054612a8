// SPDX-License-Identifier: Apache-2.0
// What three points of each part say about the parts around it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sign/containers.h"
#include "sign/point_cells.h"
#include "sign/row_hits.h"

namespace standoff {

inline constexpr std::size_t kVotes = 3;  ///< of each part

class NestingVotes {
 public:
  NestingVotes(const RowSearch& search, const BoxOrder& order, std::int64_t most_steps)
      : search_(search), around_(order, sets_), most_steps_(most_steps), votes_(order.size()), winding_(order.size()) {}

  /// The next vote, of all parts that `points` has one of. The rows of the points for which `is_first` ask not only
  /// their own parts but also the parts that they meet, so that one row suffices for thousands of nested shells. All
  /// other parts are asked by rows of their own. False if there is too much to do.
  bool vote(std::span<const PartPoint> points, std::span<const std::uint8_t> is_first);

  /// The parts around part n by most of its votes: a number of sets().
  std::uint32_t result(std::uint32_t n);
  const Sets& sets() const { return sets_; }

 private:
  struct Question {
    Vec3 at;
    std::uint32_t part;
  };
  bool ask(std::span<const PartPoint> rows);
  void ask_row(const PartPoint& row, std::span<const RowHit> hits);
  void add_met(const PartPoint& row, std::span<const RowHit> hits);
  void sweep(std::span<const RowHit> hits);
  bool is_too_much() const;

  const RowSearch& search_;
  Sets sets_;
  Around around_;
  std::int64_t most_steps_, steps_ = 0;
  std::size_t round_ = 0;
  std::vector<std::array<std::uint32_t, kVotes>> votes_;
  std::vector<std::uint8_t> waits_;    // for each part: it has not voted in this round
  std::vector<std::int32_t> winding_;  // of each part about the point of the sweep
  std::vector<Question> questions_;    // of one row, by x
};

}  // namespace standoff
