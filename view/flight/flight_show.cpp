// SPDX-License-Identifier: Apache-2.0
#include "view/flight/flight_show.h"

#include <algorithm>
#include <chrono>

#include "view/flight/frame_code.h"

namespace standoff::view {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr Seconds kFrame{1.0 / FlightShow::kFramesPerSecond};
// Flying may take this share of a frame's time; what it does not get done is left out, and the rate says so.
constexpr double kFlyingShare = 0.7;
// How fast the shown rate follows.
constexpr double kMemory = 0.9;

}  // namespace

FlightShow::FlightShow(std::unique_ptr<Flight> flight) : flight_(std::move(flight)), thread_([this] { fly(); }) {}

FlightShow::~FlightShow() {
  {
    const std::lock_guard lock(showing_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

FlightControls FlightShow::controls() const {
  const std::lock_guard lock(flying_);
  return flight_->controls();
}

void FlightShow::change(const FlightControls& controls) {
  const std::lock_guard lock(flying_);
  flight_->change(controls);
}

void FlightShow::fly() {
  auto next = Clock::now(), last = next;
  for (;;) {
    {
      std::unique_lock lock(showing_);
      if (watchers_ == 0) {
        // Not wait(), which asks for a newer libstdc++ than all else does (docs/python_packaging.md).
        while (!changed_.wait_for(lock, std::chrono::hours(1), [this] { return stop_ || watchers_ > 0; })) {
        }
        next = last = Clock::now();
      }
      changed_.wait_until(lock, next, [this] { return stop_; });
      if (stop_) return;
    }
    const auto now = Clock::now();
    // After a pause of any kind the flight goes on from where it is, it does not catch up.
    const double passed = std::min(Seconds(now - last).count(), 0.1);
    last = now;
    next = std::max(next + std::chrono::duration_cast<Clock::duration>(kFrame), now);
    try {
      fly_frame(passed);
    } catch (...) {
      const std::lock_guard lock(showing_);
      failure_ = std::current_exception();
      changed_.notify_all();
      return;
    }
  }
}

void FlightShow::fly_frame(double seconds) {
  std::string bytes;
  {
    const std::lock_guard lock(flying_);
    const std::int64_t most =
        microseconds_ > 0 ? std::max<std::int64_t>(1, std::int64_t(kFlyingShare * seconds * 1e6 / microseconds_)) : 100;
    const auto start = Clock::now();
    const std::int64_t steps = flight_->advance(seconds, most);
    if (steps > 0) {
      const double took = Seconds(Clock::now() - start).count() * 1e6 / static_cast<double>(steps);
      microseconds_ = microseconds_ > 0 ? kMemory * microseconds_ + (1 - kMemory) * took : took;
    }
    if (seconds > 0) rate_ = kMemory * rate_ + (1 - kMemory) * static_cast<double>(steps) / seconds;
    bytes = frame_bytes(flight_->frame(), rate_, microseconds_);
  }
  const std::lock_guard lock(showing_);
  frame_ = std::make_shared<const std::string>(std::move(bytes));
  ++count_;
  changed_.notify_all();
}

void FlightShow::watch(const std::function<bool(const std::string& bytes)>& show) {
  std::unique_lock lock(showing_);
  ++watchers_;
  changed_.notify_all();
  std::uint64_t seen = 0;
  for (bool more = true; more;) {
    // A moment is enough even where nothing flies: the watcher may have gone.
    changed_.wait_for(lock, std::chrono::milliseconds(200), [&] { return stop_ || failure_ || count_ != seen; });
    if (stop_ || failure_) break;
    const auto frame = count_ != seen ? frame_ : nullptr;
    seen = count_;
    lock.unlock();
    try {
      more = show(frame ? *frame : std::string());
    } catch (...) {
      lock.lock();
      --watchers_;
      throw;
    }
    lock.lock();
  }
  --watchers_;
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace standoff::view
