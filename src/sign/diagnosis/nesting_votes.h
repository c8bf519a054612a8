// SPDX-License-Identifier: Apache-2.0
// What three points of each part say about the parts around it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sign/diagnosis/containers.h"
#include "sign/diagnosis/point_cells.h"
#include "sign/diagnosis/row_hits.h"

namespace standoff {

inline constexpr std::size_t kVotes = 3;  ///< of each part

class NestingVotes {
 public:
  NestingVotes(const RowSearch& search, const BoxOrder& order, std::int64_t most_steps)
      : search_(search),
        around_(order, chains_),
        most_steps_(most_steps),
        votes_(order.size()),
        winding_(order.size()) {}

  /// The next vote, of all parts that `points` has one of. The rows of the points for which `is_first` ask not only
  /// their own parts but also the parts that they meet, so that one row suffices for thousands of nested shells. All
  /// other parts are asked by rows of their own. False if there is too much to do.
  bool vote(std::span<const PartPoint> points, std::span<const std::uint8_t> is_first);

  struct Result {
    std::int32_t depth = 0;
    std::uint32_t parent = 0;  ///< if the depth is not 0
  };
  /// How many parts are around part n by most of its votes, and the last one of them in the order.
  Result result(std::uint32_t n) const;

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
  std::int64_t size(const Containers& set) const { return chains_.length(set.chain) + set.listed; }
  std::uint32_t last(const Containers& set) const;
  void remove_last(Containers& set) const;

  const RowSearch& search_;
  Chains chains_;
  std::vector<std::uint32_t> list_;  // the one of Containers
  Around around_;
  std::int64_t most_steps_, steps_ = 0;
  std::size_t round_ = 0;
  std::vector<std::array<Containers, kVotes>> votes_;
  std::vector<std::uint8_t> waits_;    // for each part: it has not voted in this round
  std::vector<std::int32_t> winding_;  // of each part about the point of the sweep
  std::vector<Question> questions_;    // of one row, by x
};

}  // namespace standoff
