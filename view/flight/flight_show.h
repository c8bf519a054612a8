// SPDX-License-Identifier: Apache-2.0
// Flies a flight for as long as pages watch it.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "view/flight/flight.h"

namespace standoff::view {

/// A thread that flies, and gives out a frame 60 times a second; it rests while nobody watches. All members may be
/// called from several threads.
class FlightShow {
 public:
  static constexpr int kFramesPerSecond = 60;

  explicit FlightShow(std::unique_ptr<Flight> flight);
  FlightShow(const FlightShow&) = delete;
  FlightShow& operator=(const FlightShow&) = delete;
  ~FlightShow();

  FlightControls controls() const;
  /// Waits for the step that is being flown. Errors: as Flight::change().
  void change(const FlightControls& controls);

  /// Calls `show(bytes)` with each frame as frame_bytes() makes it, until that returns false. Who takes long misses
  /// frames. Throws the Error that ended the flight, if one did.
  void watch(const std::function<bool(const std::string& bytes)>& show);

 private:
  void fly();
  void fly_frame(double seconds);

  mutable std::mutex flying_;  // who holds it may use the flight
  std::unique_ptr<Flight> flight_;

  std::mutex showing_;  // the members below
  std::condition_variable changed_;
  std::shared_ptr<const std::string> frame_;
  std::uint64_t count_ = 0;  // of frames
  int watchers_ = 0;
  bool stop_ = false;
  std::exception_ptr failure_;

  // The thread's own: what was flown since it last told the rate.
  double rate_ = 0, microseconds_ = 0;
  std::thread thread_;
};

}  // namespace standoff::view
