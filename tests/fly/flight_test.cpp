// SPDX-License-Identifier: Apache-2.0
// Flights that are watched: what a watcher changes, and frames as bytes and back.
// labels: memory threads
#include "fly/flight.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <thread>

#include "tests/fly/room.h"

namespace standoff::fly {
namespace {

using namespace standoff::testing;

FlightOptions quick() {
  FlightOptions options;
  options.speed = 0.2;
  options.thickness = 0.5;
  options.threads = 1;
  return options;
}

std::unique_ptr<Flight> flight(const FlightOptions& options, std::int64_t bodies) {
  return std::make_unique<Flight>(Body(room()), Body(ball_mesh(0.3, 2)), options, bodies);
}

std::int64_t crossings(const FlightFrame& frame) {
  std::int64_t sum = 0;
  for (const Flying& it : frame.bodies) sum += it.crossings;
  return sum;
}

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// What view/page/flight_data.js does.
class Numbers {
 public:
  explicit Numbers(const std::string& bytes) : bytes_(bytes) {}
  std::int64_t next() {
    std::uint32_t n = 0, byte = 0;
    int shift = 0;
    do {
      byte = static_cast<unsigned char>(bytes_.at(at_++));
      n |= (byte & 127) << shift;
      shift += 7;
    } while (byte & 128);
    return static_cast<std::int32_t>((n >> 1) ^ (~(n & 1) + 1));
  }
  bool ended() const { return at_ == bytes_.size(); }

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

TEST(Flight, AdvancesByWholeSteps) {
  const auto it = flight(quick(), 2);
  FlightControls controls = it->controls();
  controls.steps_per_second = 30;
  it->change(controls);
  std::int64_t steps = 0;
  for (int n = 0; n < 60; ++n) steps += it->advance(1.0 / 60, 100);
  EXPECT_NEAR(static_cast<double>(steps), 30, 1);
  EXPECT_EQ(it->frame().step, steps);
  EXPECT_EQ(it->advance(1000, 7), 7);
  EXPECT_EQ(it->advance(-1, 7), 0);
}

TEST(Flight, IsWhatTheWorldFlies) {
  const auto it = flight(quick(), 3);
  it->run(50);
  FlightOptions options = quick();
  const Body walls(room()), body(ball_mesh(0.3, 2));
  options.bounds = walls.bounds();
  World world(body, options);
  world.add(walls);
  for (int n = 0; n < 3; ++n) world.add_flier(walls.bounds());
  world.run(50);
  const FlightFrame frame = it->frame();
  ASSERT_EQ(frame.bodies.size(), 3u);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(frame.bodies[n].at, apply(world.fliers()[n].pose, body.bounds().center()));
    EXPECT_GT(frame.bodies[n].distance, 0);
    const Vec3 x = rotate(world.fliers()[n].pose, {1, 0, 0});
    EXPECT_NEAR(std::cos(frame.bodies[n].heading_rad), x.x, 1e-12);
    EXPECT_NEAR(-std::sin(frame.bodies[n].heading_rad), x.z, 1e-12);
  }
}

TEST(Flight, ChangesWhileItFlies) {
  const auto it = flight(quick(), 4);
  FlightControls controls = it->controls();
  controls.speed = 5;
  controls.bodies = 9;
  it->change(controls);
  it->run(100);
  EXPECT_EQ(it->frame().bodies.size(), 9u);
  EXPECT_EQ(crossings(it->frame()), 0);
  controls.mode = FlightMode::thesis;
  it->change(controls);
  it->run(100);
  EXPECT_GT(crossings(it->frame()), 0);
  controls.bodies = 2;
  it->change(controls);
  EXPECT_EQ(it->frame().bodies.size(), 2u);
}

TEST(Flight, RefusesWhatCannotBe) {
  const auto it = flight(quick(), 1);
  const FlightControls good = it->controls();
  const auto refused = [&](auto change) {
    FlightControls controls = good;
    change(controls);
    EXPECT_THROW(it->change(controls), Error);
    EXPECT_EQ(it->controls(), good);
    EXPECT_EQ(it->frame().bodies.size(), 1u);
  };
  for (const double x : {0.0, -1.0, std::nan(""), 1 / 0.0}) refused([&](FlightControls& c) { c.speed = x; });
  for (const double x : {-1.0, std::nan(""), 1e9}) refused([&](FlightControls& c) { c.steps_per_second = x; });
  for (const std::int64_t n : {std::int64_t{0}, std::int64_t{-1}, kMostBodies + 1})
    refused([&](FlightControls& c) { c.bodies = n; });
}

TEST(FlightFrames, AreStreamed) {
  const FlightFrame frame{12, {{{1, 2, 3}, 0.5, 0.25, 7, 1}, {{-1, 0, 1e6}, -0.5, 4, 0, 0}}};
  const std::string bytes = frame_bytes(frame, 60, 1.5);
  ASSERT_EQ(bytes.size(), 24u + 2 * 28);
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 0), bytes.size());
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 4), 2u);
  EXPECT_EQ(number_at<double>(bytes, 8), 12);
  EXPECT_EQ(number_at<float>(bytes, 16), 60);
  EXPECT_EQ(number_at<float>(bytes, 20), 1.5);
  const float expected[] = {1, 2, 3, 0.25, 0.5};
  for (std::size_t n = 0; n < 5; ++n) EXPECT_EQ(number_at<float>(bytes, 24 + 4 * n), expected[n]) << n;
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 44), 7u);
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 48), 1u);
  EXPECT_EQ(number_at<float>(bytes, 60), 1e6f);
}

TEST(FlightFrames, OfARecordComeBack) {
  const auto it = flight(quick(), 3);
  const auto frames = recorded(*it, 95, 10);
  ASSERT_EQ(frames.size(), 11u);
  EXPECT_EQ(frames.back().step, 95);
  const CodedFlight coded = coded_flight(frames);
  EXPECT_EQ(coded.frames, 11);
  EXPECT_EQ(coded.bodies, 3);
  Numbers positions(coded.positions), distances(coded.distances), collisions(coded.collisions),
      crossed(coded.crossings), steps(coded.steps);
  std::int64_t step = 0;
  for (const FlightFrame& frame : frames) EXPECT_EQ(step += steps.next(), frame.step);
  for (std::size_t body = 0; body < 3; ++body) {
    for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      std::int64_t last = 0, before = 0;
      for (std::size_t n = 0; n < frames.size(); ++n) {
        const std::int64_t now = positions.next() + (n == 0 ? 0 : n == 1 ? last : 2 * last - before);
        EXPECT_NEAR(coded.origin.*axis + coded.step * static_cast<double>(now), frames[n].bodies[body].at.*axis,
                    coded.step * 0.51);
        before = last;
        last = now;
      }
    }
    std::int64_t distance = 0, collided = 0, passed = 0;
    for (const FlightFrame& frame : frames) {
      EXPECT_NEAR(coded.step * static_cast<double>(distance += distances.next()), frame.bodies[body].distance,
                  coded.step * 0.51);
      EXPECT_EQ(collided += collisions.next(), frame.bodies[body].collisions);
      EXPECT_EQ(passed += crossed.next(), frame.bodies[body].crossings);
    }
    EXPECT_EQ(number_at<float>(coded.headings, 4 * body), static_cast<float>(frames[0].bodies[body].heading_rad));
  }
  for (const Numbers& all : {positions, distances, collisions, crossed, steps}) EXPECT_TRUE(all.ended());
}

TEST(FlightFrames, OfStraightFlightsAreSmall) {
  std::vector<FlightFrame> frames;
  for (int n = 0; n < 1000; ++n) frames.push_back({n, {{{n * 0.5, 0, n * 0.25}, 0, 1, 0, 0}}});
  const CodedFlight coded = coded_flight(frames);
  const auto bends = std::ranges::count_if(coded.positions, [](char c) { return c != 0; });
  EXPECT_LT(bends, 1500);  // the second axis has none; rounding makes some on the others
  EXPECT_LE(coded.positions.size(), 3010u);
}

TEST(FlightFrames, NeedTheSameBodies) {
  EXPECT_THROW(coded_flight({}), Error);
  const std::vector<FlightFrame> frames{{0, {{}}}, {1, {{}, {}}}};
  EXPECT_THROW(coded_flight(frames), Error);
}

TEST(FlightShow, FliesForThoseWhoWatch) {
  FlightShow show(flight(quick(), 3));
  std::atomic<int> frames{0};
  std::atomic<bool> enough{false};
  std::vector<std::thread> watchers;
  for (int n = 0; n < 3; ++n)
    watchers.emplace_back([&] {
      double last = -1;
      show.watch([&](const std::string& bytes) {
        if (bytes.empty()) return !enough.load();
        EXPECT_GE(number_at<double>(bytes, 8), last);
        last = number_at<double>(bytes, 8);
        ++frames;
        return !enough.load();
      });
    });
  for (int n = 0; n < 20; ++n) {
    FlightControls controls = show.controls();
    controls.bodies = 1 + n % 5;
    controls.speed = 0.1 + 0.01 * n;
    show.change(controls);
    EXPECT_EQ(show.controls(), controls);
  }
  FlightControls bad = show.controls();
  bad.speed = -1;
  EXPECT_THROW(show.change(bad), Error);
  while (frames < 10) std::this_thread::yield();
  enough = true;
  for (std::thread& watcher : watchers) watcher.join();
}

TEST(FlightShow, EndsWithAWatcherThatThrows) {
  FlightShow show(flight(quick(), 1));
  EXPECT_THROW(show.watch([](const std::string&) -> bool { throw 5; }), int);
  int frames = 0;
  show.watch([&](const std::string& bytes) { return bytes.empty() || ++frames < 2; });
  EXPECT_EQ(frames, 2);
}

}  // namespace
}  // namespace standoff::fly
