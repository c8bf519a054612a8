// SPDX-License-Identifier: Apache-2.0
// Finds where triangles cross the rows of a grid: in single precision (cpu/kernels.h), and exactly (ray_crossing.h)
// where its rounding might change the answer. Crossings are listed in blocks that never move.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "sign/cpu/kernels.h"
#include "sign/oriented_mesh.h"
#include "sign/rows/ray_crossing.h"
#include "sign/rows/sample_axis.h"
#include "standoff/grid.h"

namespace standoff {

/// A crossing of a triangle with a row of a window of rows.
struct FoundCrossing {
  static constexpr int kRowBits = 23, kPastBits = 40;
  std::uint64_t bits;

  /// `directed_row`: 2 * row + (whether the row enters the solid). `past`: the first sample past the triangle.
  static FoundCrossing make(std::uint64_t directed_row, std::uint64_t past) {
    return {directed_row << kPastBits | past};
  }
  /// 64 * row of tiles + row in the tile (y + 8 z). Rows of tiles are numbered ty + tiles_y * tz, from the window's
  /// first one.
  std::uint64_t row() const { return bits >> (kPastBits + 1); }
  std::uint64_t past() const { return bits & ((std::uint64_t{1} << kPastBits) - 1); }
  /// Whether the row enters the solid there, or else leaves it.
  bool enters() const { return (bits >> kPastBits & 1) != 0; }
};

/// The number of blocks that all threads together may still take.
class BlockBudget {
 public:
  explicit BlockBudget(std::int64_t blocks) : left_(blocks) {}
  bool take() { return left_.fetch_sub(1, std::memory_order_relaxed) > 0; }
  bool is_spent() const { return left_.load(std::memory_order_relaxed) < 0; }

 private:
  std::atomic<std::int64_t> left_;
};

class CrossingList {
 public:
  static constexpr std::size_t kBlock = 4096;  ///< 32 KiB
  static constexpr std::ptrdiff_t kMostAtOnce = 64;
  using Block = std::array<FoundCrossing, kBlock>;

  explicit CrossingList(BlockBudget& budget) : budget_(&budget) {}
  /// The progress can end the work at each block.
  CrossingList(BlockBudget& budget, ProgressMeter& progress) : budget_(&budget), progress_(&progress) {}

  /// Adds `count` crossings, at most kMostAtOnce, and returns the first one, to be filled; null if the budget is spent.
  FoundCrossing* add(std::ptrdiff_t count) {
    if (end_ - next_ < count && !take_block()) return nullptr;
    return std::exchange(next_, next_ + count);
  }
  /// Calls use(crossings) for each block.
  template <class Use>
  void for_each_block(const Use& use) const {
    for (std::size_t n = 0; n < blocks_.size(); ++n)
      use(std::span<const FoundCrossing>(blocks_[n]->data(), n + 1 < blocks_.size() ? sizes_[n] : size_of_last()));
  }
  std::size_t blocks() const { return blocks_.size(); }

 private:
  std::size_t size_of_last() const { return static_cast<std::size_t>(next_ - blocks_.back()->data()); }
  bool take_block() {
    if (progress_) progress_->check();
    if (!budget_->take()) return false;
    if (!blocks_.empty()) sizes_.push_back(size_of_last());
    blocks_.push_back(std::make_unique_for_overwrite<Block>());
    next_ = blocks_.back()->data();
    end_ = next_ + kBlock;
    return true;
  }

  BlockBudget* budget_;
  ProgressMeter* progress_ = nullptr;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::vector<std::size_t> sizes_;  // of all blocks but the last
  FoundCrossing* next_ = nullptr;
  FoundCrossing* end_ = nullptr;
};

/// Rows of a grid: whole rows of tiles, or one row alone. begin <= row < end along y and along z, within the grid. At
/// most 2^17 rows of tiles.
struct RowWindow {
  std::array<std::int64_t, 2> begin, end;
};

class RowScan {
 public:
  /// Requires a valid mesh and grid; the mesh outlives the scan.
  RowScan(const OrientedMesh& mesh, const Grid& grid, Simd simd = Simd::automatic);

  /// Adds the crossings of triangles first to end - 1 with the window's rows to the list, unless they are past the last
  /// sample. Returns whether the list had room for all.
  bool scan(std::size_t first, std::size_t end, const RowWindow& window, CrossingList& list) const;

 private:
  struct Batch;

  template <bool kPacked>
  bool scan_filtered(std::size_t first, std::size_t end, Batch& batch) const;
  bool add_triangles(Batch& batch) const;
  bool add_strips(int n, Batch& batch) const;
  bool add_strip(const cpu::RowStrip& strip, Batch& batch) const;
  bool finish(Batch& batch) const;
  bool add_all_exactly(std::size_t triangle, Batch& batch) const;
  bool add_rows_exactly(std::size_t triangle, const RowWindow& rows, Batch& batch) const;
  bool add_exactly(std::size_t triangle, const RayTriangle& ray, std::int64_t j, std::int64_t k, Batch& batch) const;

  OrientedMesh mesh_;
  Grid grid_;
  SampleAxis x_, y_, z_;
  double slack_;  // the most that a coordinate in samples may be off by
  bool filters_;  // whether single precision can decide any row
  const cpu::SignKernels* kernels_;
};

}  // namespace standoff
