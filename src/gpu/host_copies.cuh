// SPDX-License-Identifier: Apache-2.0
// Copies between the device and host memory that is not pinned, which a driver moves piece by piece on one thread. Here
// several threads of the host move the pieces through pinned memory, while others are under way.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include "core/side_by_side.h"
#include "gpu/platform.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// A worker has two pieces: it works on one while the other is under way. Larger pieces are copied no faster, from some
/// 256 KiB on.
inline constexpr std::int64_t kPieceBytes = std::int64_t{1} << 20;
/// Eight threads move bytes as fast as the bus does.
inline constexpr int kCopyWorkers = 8;

/// The pinned memory of a call's copies. It is kept for later calls, as pinning it takes longer than copying 100 MiB.
/// All copies go through the default stream.
class Pieces {
 public:
  static constexpr std::int64_t kBytes = kPieceBytes * 2 * kCopyWorkers;

  class Piece {
   public:
    void* at() const { return at_; }
    /// Marks what was put on the stream so far; wait() waits for that.
    void mark() { done_.record(nullptr); }
    void wait() { done_.wait(); }

   private:
    friend Pieces;
    void* at_ = nullptr;
    Event done_;
  };

  Pieces() : memory_(kBytes) {
    for (std::size_t n = 0; n < pieces_.size(); ++n)
      pieces_[n].at_ = static_cast<char*>(memory_.at()) + static_cast<std::int64_t>(n) * kPieceBytes;
  }
  /// One of the worker's two.
  Piece& of(int worker, bool second) { return pieces_[static_cast<std::size_t>(2 * worker + second)]; }

 private:
  PinnedMemory memory_;
  std::array<Piece, 2 * kCopyWorkers> pieces_;
};

/// The pieces kept on this device, or new ones if another call uses them. Waits for the copies at its end, whatever
/// ended it.
class BorrowedPieces {
 public:
  BorrowedPieces() : device_(current_device()) {
    const std::lock_guard lock(kept().taking);
    Kept& all = kept();
    if (all.device == device_) mine_ = std::move(all.pieces);
    if (!mine_) mine_ = std::make_unique<Pieces>();
  }
  ~BorrowedPieces() {
    finish_copies();
    const std::lock_guard lock(kept().taking);
    kept().device = device_;
    kept().pieces.swap(mine_);
  }
  BorrowedPieces(const BorrowedPieces&) = delete;
  BorrowedPieces& operator=(const BorrowedPieces&) = delete;

  int device() const { return device_; }
  Pieces* operator->() const { return mine_.get(); }

 private:
  struct Kept {
    std::mutex taking;
    int device = 0;
    std::unique_ptr<Pieces> pieces;
  };
  // It is never destroyed: CUDA may end before this library does.
  static Kept& kept() {
    static Kept& all = *new Kept;
    return all;
  }

  int device_;
  std::unique_ptr<Pieces> mine_;
};

/// Copies `count` items of `item_bytes` each to the device. fill(piece, first, count) writes the next ones to a piece;
/// it is called from several threads.
template <class Fill>
void copy_in_by_pieces(int threads, void* to, std::int64_t count, std::int64_t item_bytes, const Fill& fill) {
  const std::int64_t at_once = kPieceBytes / item_bytes, pieces = (count + at_once - 1) / at_once;
  const BorrowedPieces borrowed;
  std::atomic<std::int64_t> next{0};
  side_by_side(threads, static_cast<int>(std::min<std::int64_t>(kCopyWorkers, pieces)), [&](int worker) {
    const DeviceScope scope(borrowed.device());
    bool second = false;
    for (std::int64_t n = next++; n < pieces; n = next++, second = !second) {
      Pieces::Piece& piece = borrowed->of(worker, second);
      piece.wait();
      const std::int64_t first = n * at_once, here = std::min(at_once, count - first);
      fill(piece.at(), first, here);
      copy_in_later(static_cast<char*>(to) + first * item_bytes, piece.at(), here * item_bytes, nullptr);
      piece.mark();
    }
  });
  wait_for(nullptr);
}

/// Copies `count` items from the device, so many at once as `at_once` says: copy(piece, first, count) puts their copies
/// to a piece on the default stream, and use(piece, first, count) is called when they are there. A worker takes `taken`
/// items in a row; begin(worker, first, count) is called before their first copy. All are called from several threads.
template <class Begin, class Copy, class Use>
void copy_out_by_pieces(int threads, std::int64_t count, std::int64_t taken, std::int64_t at_once, const Begin& begin,
                        const Copy& copy, const Use& use) {
  const std::int64_t ranges = (count + taken - 1) / taken;
  const BorrowedPieces borrowed;
  std::atomic<std::int64_t> next{0};
  side_by_side(threads, static_cast<int>(std::min<std::int64_t>(kCopyWorkers, ranges)), [&](int worker) {
    const DeviceScope scope(borrowed.device());
    for (std::int64_t n = next++; n < ranges; n = next++) {
      const std::int64_t from = n * taken, to = std::min(count, from + taken);
      begin(worker, from, to - from);
      const auto size = [&](std::int64_t first) { return std::min(at_once, to - first); };
      const auto ask = [&](std::int64_t first) {
        if (first >= to) return;
        Pieces::Piece& piece = borrowed->of(worker, (first - from) / at_once % 2 != 0);
        copy(piece.at(), first, size(first));
        piece.mark();
      };
      ask(from);
      for (std::int64_t first = from; first < to; first += at_once) {
        ask(first + at_once);
        Pieces::Piece& piece = borrowed->of(worker, (first - from) / at_once % 2 != 0);
        piece.wait();
        use(worker, piece.at(), first, size(first));
      }
    }
  });
}

}  // namespace standoff::STANDOFF_PLATFORM
