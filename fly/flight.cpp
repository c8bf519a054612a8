// SPDX-License-Identifier: Apache-2.0
#include "fly/flight.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <string>

#include "page/page.h"
#include "standoff/error.h"

namespace standoff::fly {
namespace {

FlightOptions inside(const Body& walls, FlightOptions options) {
  options.bounds = walls.bounds();
  return options;
}

void check(const FlightControls& controls) {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::usage, what); };
  if (!(controls.speed > 0) || !std::isfinite(controls.speed))
    fail("the speed is not positive; give world units a step");
  if (controls.bodies < 1 || controls.bodies > kMostBodies)
    fail("so many flies cannot be watched; give 1 to " + std::to_string(kMostBodies));
  if (!(controls.steps_per_second >= 0 && controls.steps_per_second <= kMostSteps))
    fail("so many steps a second cannot be watched; give 0 to 100000");
}

}  // namespace

Flight::Flight(const Body& walls, const Body& flier, const FlightOptions& options, std::int64_t bodies)
    : world_(flier, inside(walls, options)), box_(walls.bounds()), middle_(flier.bounds().center()) {
  world_.add(walls);
  controls_ = {options.mode, options.on_contact, options.speed, bodies, 60};
  check(controls_);
  for (std::int64_t n = 0; n < bodies; ++n) world_.add_flier(box_);
}

void Flight::change(const FlightControls& controls) {
  check(controls);
  const FlightOptions before = world_.options();
  FlightOptions options = before;
  options.mode = controls.mode;
  options.on_contact = controls.on_contact;
  options.speed = controls.speed;
  if (options.mode != before.mode || options.speed != before.speed || options.on_contact != before.on_contact)
    world_.set_options(options);
  try {
    while (world_.fliers().size() < static_cast<std::size_t>(controls.bodies)) world_.add_flier(box_);
  } catch (...) {
    world_.keep_fliers(static_cast<std::size_t>(controls_.bodies));
    world_.set_options(before);
    throw;
  }
  world_.keep_fliers(static_cast<std::size_t>(controls.bodies));
  controls_ = controls;
}

std::int64_t Flight::advance(double seconds, std::int64_t most_steps) {
  due_ += std::max(0.0, seconds) * controls_.steps_per_second;
  const double whole = std::floor(due_);
  due_ -= whole;
  const std::int64_t steps = std::min(static_cast<std::int64_t>(std::min(whole, 1e15)), most_steps);
  run(steps);
  return steps;
}

void Flight::run(std::int64_t steps) {
  world_.run(steps);
  step_ += steps;
}

FlightFrame Flight::frame() {
  const auto fliers = world_.fliers();
  std::vector<double> distances(fliers.size());
  world_.wall_distances(distances);
  FlightFrame frame{step_, {}};
  frame.bodies.reserve(fliers.size());
  for (std::size_t n = 0; n < fliers.size(); ++n) {
    const Flier& it = fliers[n];
    const Vec3 x = rotate(it.pose, {1, 0, 0});
    frame.bodies.push_back({apply(it.pose, middle_), std::atan2(-x.z, x.x), distances[n], it.collisions, it.crossings});
  }
  return frame;
}

std::vector<FlightFrame> recorded(Flight& flight, std::int64_t steps, std::int64_t every,
                                  const ProgressCallback& progress) {
  std::vector<FlightFrame> frames{flight.frame()};
  for (std::int64_t done = 0; done < steps;) {
    const std::int64_t now = std::min(every, steps - done);
    flight.run(now);
    done += now;
    frames.push_back(flight.frame());
    if (progress && !progress({"fly", static_cast<double>(done) / static_cast<double>(steps)}))
      throw Error(ErrorCode::interrupted, "interrupted");
  }
  return frames;
}

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

namespace {

static_assert(std::endian::native == std::endian::little);

template <class T>
void put(std::string& out, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

void put_signed(std::string& out, std::int64_t n) {
  page::put_varint(out, page::zigzag(static_cast<std::int32_t>(std::clamp<std::int64_t>(n, INT32_MIN, INT32_MAX))));
}

constexpr double kSteps = 65535;

// `of(frame)` is a whole number of a body; its change from frame to frame.
void put_changes(std::string& out, std::span<const FlightFrame> frames, auto of) {
  std::int64_t last = 0;
  for (const FlightFrame& frame : frames) {
    const std::int64_t now = of(frame);
    put_signed(out, now - last);
    last = now;
  }
}

void put_bends(std::string& out, std::span<const FlightFrame> frames, auto of) {
  std::int64_t last = 0, before = 0;
  for (const FlightFrame& frame : frames) {
    const std::int64_t now = of(frame);
    put_signed(out, now - (&frame == &frames[0] ? 0 : &frame == &frames[1] ? last : 2 * last - before));
    before = last;
    last = now;
  }
}

}  // namespace

std::string frame_bytes(const FlightFrame& frame, double steps_per_second, double microseconds) {
  std::string bytes;
  bytes.reserve(24 + 28 * frame.bodies.size());
  put(bytes, static_cast<std::uint32_t>(24 + 28 * frame.bodies.size()));
  put(bytes, static_cast<std::uint32_t>(frame.bodies.size()));
  put(bytes, static_cast<double>(frame.step));
  put(bytes, static_cast<float>(steps_per_second));
  put(bytes, static_cast<float>(microseconds));
  for (const Flying& body : frame.bodies) {
    for (const double number : {body.at.x, body.at.y, body.at.z, body.distance, body.heading_rad})
      put(bytes, static_cast<float>(number));
    put(bytes, static_cast<std::uint32_t>(body.collisions));
    put(bytes, static_cast<std::uint32_t>(body.crossings));
  }
  return bytes;
}

CodedFlight coded_flight(std::span<const FlightFrame> frames) {
  if (frames.empty()) throw Error(ErrorCode::usage, "a flight without frames cannot be shown; record some steps");
  CodedFlight coded;
  coded.frames = std::ssize(frames);
  coded.bodies = std::ssize(frames[0].bodies);
  Box box;
  for (const FlightFrame& frame : frames) {
    if (std::ssize(frame.bodies) != coded.bodies)
      throw Error(ErrorCode::usage, "a recorded flight keeps its bodies; record each number of them alone");
    for (const Flying& body : frame.bodies) box.include(body.at);
  }
  if (!box.empty()) {
    coded.origin = box.min;
    if (box.longest_side() > 0) coded.step = box.longest_side() / kSteps;
  }
  const auto whole = [&](double length) {
    return static_cast<std::int64_t>(std::llround(std::clamp(length / coded.step, -1e9, 1e9)));
  };
  for (std::size_t n = 0; n < frames[0].bodies.size(); ++n) {
    const auto body = [n](const FlightFrame& frame) -> const Flying& { return frame.bodies[n]; };
    for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z})
      put_bends(coded.positions, frames,
                [&](const FlightFrame& frame) { return whole(body(frame).at.*axis - coded.origin.*axis); });
    put_changes(coded.distances, frames, [&](const FlightFrame& frame) { return whole(body(frame).distance); });
    put_changes(coded.collisions, frames, [&](const FlightFrame& frame) { return body(frame).collisions; });
    put_changes(coded.crossings, frames, [&](const FlightFrame& frame) { return body(frame).crossings; });
    put(coded.headings, static_cast<float>(body(frames[0]).heading_rad));
  }
  put_changes(coded.steps, frames, [](const FlightFrame& frame) { return frame.step; });
  return coded;
}

}  // namespace standoff::fly
