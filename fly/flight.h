// SPDX-License-Identifier: Apache-2.0
// A flight that is watched: what is shown of it, what a watcher may change while it goes on, and frames as bytes.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "fly/world.h"
#include "standoff/collision.h"
#include "standoff/vec.h"

namespace standoff::fly {

/// One moving body at one moment.
struct Flying {
  Vec3 at;                      ///< the middle of its box
  double heading_rad = 0;       ///< how far it is turned about the y axis
  double distance = 0;          ///< from `at` to the nearest wall, world units
  std::int64_t collisions = 0;  ///< so far, by this body
  std::int64_t crossings = 0;
};

struct FlightFrame {
  std::int64_t step = 0;  ///< since the beginning
  std::vector<Flying> bodies;
};

struct FlightControls {
  FlightMode mode = FlightMode::sweep;
  OnContact on_contact = OnContact::turn_back;
  double speed = 0.02;           ///< world units a step
  std::int64_t bodies = 1;       ///< 1 to kMostBodies
  double steps_per_second = 60;  ///< 0 stops it; at most kMostSteps

  friend bool operator==(const FlightControls&, const FlightControls&) = default;
};
inline constexpr std::int64_t kMostBodies = 1000;
inline constexpr double kMostSteps = 100'000;

class Flight {
 public:
  /// Bodies start at random places in the walls' box. Errors: as World.
  Flight(const Body& walls, const Body& flier, const FlightOptions& options, std::int64_t bodies);

  const FlightControls& controls() const { return controls_; }
  /// Errors: usage; input (no room for so many); the flight goes on as before.
  void change(const FlightControls& controls);

  /// Flies as many steps as `seconds` have at the controls' rate, whole ones; what is left over counts the next time.
  /// Never more than `most_steps`. Returns how many.
  std::int64_t advance(double seconds, std::int64_t most_steps);
  void run(std::int64_t steps);
  FlightFrame frame();
  const World& world() const { return world_; }

 private:
  World world_;
  Box box_;
  Vec3 middle_;
  FlightControls controls_;
  double due_ = 0;  // steps, a fraction of one
  std::int64_t step_ = 0;
};

/// A flight of `steps` steps as it is shown later: a frame at the beginning, and after every `every` steps.
std::vector<FlightFrame> recorded(Flight& flight, std::int64_t steps, std::int64_t every,
                                  const ProgressCallback& progress = {});

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

/// A frame as it is streamed, little endian: its length in bytes (4, these included), the number of bodies (4), the
/// step (8, a double), steps a second (4, a float), microseconds that a step takes to compute (4, a float); then for
/// each body x, y, z, distance and heading (4 each, floats), its collisions and crossings (4 each).
std::string frame_bytes(const FlightFrame& frame, double steps_per_second, double microseconds);

/// All frames of a recorded flight. Numbers are varints of zigzags (src/page/page.h), which deflate packs well:
/// most of them are 0.
struct CodedFlight {
  Vec3 origin;      ///< the least corner of the box of all positions
  double step = 1;  ///< world units, of positions and distances: the box's longest side in 2^16 - 1 steps
  std::int64_t frames = 0, bodies = 0;
  /// Of each body, of x, y, then z: what is left, in each frame, of the position after a straight continuation of the
  /// two frames before. Nothing is, as long as the body flies straight on.
  std::string positions;
  std::string distances;   ///< of each body: the change in each frame
  std::string headings;    ///< of each body: a float, little endian
  std::string collisions;  ///< of each body: the change in each frame
  std::string crossings;   ///< the same
  std::string steps;       ///< the change in each frame
};
/// Errors: usage (no frame; frames with different numbers of bodies).
CodedFlight coded_flight(std::span<const FlightFrame> frames);

}  // namespace standoff::fly
