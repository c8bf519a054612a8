// SPDX-License-Identifier: Apache-2.0
// Copies between the device and host memory that is not pinned, which a driver moves piece by piece on one thread. Here
// several threads of the host move the pieces through pinned memory, while others are under way.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "core/side_by_side.h"
#include "gpu/platform.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// A worker has two pieces: it works on one while the other is under way. The size decides time alone, and others were
/// not measured in use: 4 MiB at once are copied at nine tenths of the speed of 100 MiB (H100).
inline constexpr std::int64_t kPieceBytes = std::int64_t{1} << 20;
/// Eight threads move bytes as fast as the bus does (60 and 55 GB/s beside an H100).
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

/// The pieces kept for the current device, or new ones if another call uses them.
class BorrowedPieces {
 public:
  BorrowedPieces() : device_(current_device()) {
    {
      const std::lock_guard lock(kept().taking);
      mine_ = std::move(kept().of_device[device_]);
    }
    if (!mine_) mine_ = std::make_unique<Pieces>();
  }
  /// If an exception ends the call, copies may be under way still.
  ~BorrowedPieces() {
    if (mine_) finish_copies();
  }
  BorrowedPieces(const BorrowedPieces&) = delete;
  BorrowedPieces& operator=(const BorrowedPieces&) = delete;

  int device() const { return device_; }
  Pieces* operator->() const { return mine_.get(); }

  /// Once all copies are done: keeps the pieces for the next call, if no other call has left some meanwhile.
  void give_back() {
    std::unique_ptr<Pieces> done = std::move(mine_);  // freed at the end, outside of the lock
    const std::lock_guard lock(kept().taking);
    std::unique_ptr<Pieces>& place = kept().of_device[device_];
    if (!place) place = std::move(done);
  }

 private:
  struct Kept {
    std::mutex taking;
    std::map<int, std::unique_ptr<Pieces>> of_device;
  };
  // It is never destroyed: CUDA may end before this library does.
  static Kept& kept() {
    static Kept& all = *new Kept;
    return all;
  }

  int device_;
  std::unique_ptr<Pieces> mine_;
};

/// The number of workers for so many bytes: each has a piece at least.
inline int copy_workers(std::int64_t bytes) {
  return static_cast<int>(std::clamp<std::int64_t>(bytes / kPieceBytes, 1, kCopyWorkers));
}

/// Calls work(worker, n) for n from 0 to count - 1, on several workers with the device of the pieces. After an
/// exception no further n is begun.
template <class Work>
void share_out(int threads, int workers, int device, std::int64_t count, const Work& work) {
  std::atomic<std::int64_t> next{0};
  side_by_side(threads, workers, [&](int worker) {
    const DeviceScope scope(device);
    try {
      for (std::int64_t n = next++; n < count; n = next++) work(worker, n);
    } catch (...) {
      next = count;
      throw;
    }
  });
}

/// `count` items of `item_bytes` each, for the device's memory at `to`. fill(piece, first, count) writes the next ones
/// to a piece.
struct HostArray {
  void* to;
  std::int64_t count, item_bytes;
  std::function<void(void* piece, std::int64_t first, std::int64_t count)> fill;

  std::int64_t at_once() const { return kPieceBytes / item_bytes; }
  std::int64_t pieces() const { return (count + at_once() - 1) / at_once(); }
};

/// Copies arrays to the device. They are filled from several threads.
inline void copy_in_by_pieces(int threads, std::initializer_list<HostArray> arrays) {
  std::int64_t pieces = 0, bytes = 0;
  for (const HostArray& array : arrays) pieces += array.pieces(), bytes += array.count * array.item_bytes;
  BorrowedPieces borrowed;
  std::array<bool, kCopyWorkers> second{};  // the piece of a worker whose turn it is
  share_out(threads, copy_workers(bytes), borrowed.device(), pieces, [&](int worker, std::int64_t n) {
    const HostArray* array = arrays.begin();
    for (; n >= array->pieces(); ++array) n -= array->pieces();
    bool& turn = second[static_cast<std::size_t>(worker)];
    Pieces::Piece& piece = borrowed->of(worker, turn);
    turn = !turn;
    piece.wait();
    const std::int64_t first = n * array->at_once(), count = std::min(array->at_once(), array->count - first);
    array->fill(piece.at(), first, count);
    copy_in_later(static_cast<char*>(array->to) + first * array->item_bytes, piece.at(), count * array->item_bytes,
                  nullptr);
    piece.mark();
  });
  wait_for(nullptr);
  borrowed.give_back();
}

/// How copies from the device are cut: a worker takes `taken` items in a row, and copies them `at_once` at a time.
struct CutOfCopies {
  std::int64_t count, item_bytes, taken, at_once;
};

/// Copies items from the device: copy(piece, first, count) puts their copies to a piece on the default stream, and
/// use(worker, piece, first, count) is called when they are there. begin(worker, first, count) is called for the items
/// that a worker takes, before their first copy. All are called from several threads.
template <class Begin, class Copy, class Use>
void copy_out_by_pieces(int threads, const CutOfCopies& cut, const Begin& begin, const Copy& copy, const Use& use) {
  const std::int64_t ranges = (cut.count + cut.taken - 1) / cut.taken;
  const int workers = copy_workers(cut.count * cut.item_bytes);
  BorrowedPieces borrowed;
  share_out(threads, workers, borrowed.device(), ranges, [&](int worker, std::int64_t n) {
    const std::int64_t from = n * cut.taken, to = std::min(cut.count, from + cut.taken);
    begin(worker, from, to - from);
    const auto piece_of = [&](std::int64_t first) -> Pieces::Piece& {
      return borrowed->of(worker, (first - from) / cut.at_once % 2 != 0);
    };
    const auto size_of = [&](std::int64_t first) { return std::min(cut.at_once, to - first); };
    const auto ask = [&](std::int64_t first) {
      if (first >= to) return;
      copy(piece_of(first).at(), first, size_of(first));
      piece_of(first).mark();
    };
    ask(from);
    for (std::int64_t first = from; first < to; first += cut.at_once) {
      ask(first + cut.at_once);
      piece_of(first).wait();
      use(worker, piece_of(first).at(), first, size_of(first));
    }
  });
  borrowed.give_back();
}

}  // namespace standoff::STANDOFF_PLATFORM
