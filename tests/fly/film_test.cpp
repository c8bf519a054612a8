// SPDX-License-Identifier: Apache-2.0
// Flights as pictures: what is seen of contacts and crossings, and that what stands need not be drawn again.
// labels: memory
#include <gtest/gtest.h>

#include <algorithm>

#include "fly/flight_pictures.h"
#include "tests/fly/room.h"

namespace standoff::fly {
namespace {

using namespace standoff::testing;

// One body that flies along x; it touches a wall at the frame `touches`, and passes through one at `crosses`.
std::vector<FlightFrame> frames(int count, int touches, int crosses) {
  std::vector<FlightFrame> all;
  for (int n = 0; n < count; ++n)
    all.push_back({n, {{{2 + 0.2 * n, 2, 3}, 0.3, 0.5, n >= touches ? 1 : 0, n >= crosses ? 1 : 0}}});
  return all;
}

FlightSubject subject() {
  const Body walls(room()), body(ball_mesh(0.3, 3));
  return flight_subject("room", walls, body, {});
}

PictureOptions small() {
  PictureOptions options;
  options.width = 640, options.height = 480;
  options.up = Axis::y;
  options.threads = 1;
  return options;
}

// Where a picture is magenta, which no colour of a distance is.
int magenta(const Image& image) {
  return static_cast<int>(std::ranges::count_if(
      image.pixels, [](const Color& c) { return c[0] > 190 && c[1] < 60 && c[2] > 120 && c[2] < 230; }));
}

TEST(Trails, PointsStandWhereSomethingHappenedAndASpacingApart) {
  Trails trails(0.5, 10);
  const auto flight = frames(12, 4, 7);
  for (const FlightFrame& frame : flight) trails.take(frame);
  const Trail& trail = trails.trails()[0];
  std::vector<double> x;
  for (const Vec3& p : trail.points) x.push_back(std::round(10 * (p.x - 2)) / 2);
  EXPECT_EQ(x, (std::vector<double>{0, 3, 4, 7, 10}));  // steps: each third one, and those of contact and crossing
  EXPECT_EQ(trail.distances.size(), trail.points.size());
  EXPECT_NEAR(trail.since_contact, 0.7, 1e-12);
  ASSERT_EQ(trails.crossings().size(), 1U);
  EXPECT_NEAR(trails.crossings()[0].x, 2 + 0.2 * 6.5, 1e-12);
}

TEST(Trails, AreNotEndless) {
  Trails trails(0.1, 10);
  for (const FlightFrame& frame : frames(7000, 0, 0)) trails.take(frame);
  EXPECT_EQ(trails.trails()[0].points.size(), 6000U);
  EXPECT_NEAR(trails.trails()[0].points.back().x, 2 + 0.2 * 6999, 1e-9);
}

TEST(FlightPictures, ContactsAreSeenForAWhile) {
  const auto flight = frames(10, 3, 100);
  const FlightSubject shown = subject();
  FlightPictures pictures(shown, flight, 10, small());
  std::vector<int> seen;
  for (std::size_t n = 0; n < pictures.count(); ++n) seen.push_back(magenta(pictures.next()));
  // The ring for three frames, the number of contacts in the corner ever after.
  for (int n = 0; n < 3; ++n) EXPECT_EQ(seen[n], 0) << n;
  for (int n = 3; n < 6; ++n) EXPECT_GT(seen[n], seen[9] + 100) << n;
  EXPECT_GT(seen[9], 0);
}

TEST(FlightPictures, CrossingsStay) {
  const FlightSubject shown = subject();
  const auto with = frames(10, 100, 4), without = frames(10, 100, 100);
  const auto last = [&](const std::vector<FlightFrame>& flight) {
    FlightPictures pictures(shown, flight, 10, small());
    Image image = pictures.next();
    for (std::size_t n = 1; n < pictures.count(); ++n) image = pictures.next();
    return image;
  };
  const Image a = last(with), b = last(without);
  const auto dark = [](const Image& image) {
    return std::ranges::count_if(image.pixels, [](const Color& c) { return c[0] < 90 && c[1] < 90 && c[2] < 90; });
  };
  EXPECT_GT(dark(a), dark(b) + 30);
}

// Where nothing moves the picture of the walls is taken: the pixels are those of a stage that draws everything.
TEST(FlightPictures, WhatStandsNeedNotBeDrawnAgain) {
  const Mesh walls = room(), ball = ball_mesh(0.3, 3);
  Drawing standing, moving;
  standing.meshes.push_back({.mesh = walls, .opacity = 0.2});
  moving.meshes.push_back({.mesh = ball});
  const Camera camera(small());
  Stage kept(standing, small()), whole(standing, small());
  const auto extent = whole.extent(camera);
  kept.keep(camera, extent);
  for (const double x : {1.0, 5.0, 9.0}) {
    Mesh there = ball;
    for (Vec3& vertex : there.vertices) vertex = vertex + Vec3{x, 2, 3};
    Drawing now;
    now.meshes.push_back({.mesh = there, .color = {200, 30, 30}});
    kept.move(now);
    whole.move(now);
    const Image a = kept.draw(camera, extent), b = whole.draw(camera, extent);
    EXPECT_EQ(a.pixels, b.pixels) << x;
    EXPECT_TRUE(std::ranges::any_of(a.pixels, [](const Color& c) { return c[0] > c[1] + 60; })) << x;
  }
}

TEST(FlightPictures, NoFramesAreNoFilm) {
  const FlightSubject shown = subject();
  EXPECT_THROW(FlightPictures(shown, {}, 10, small()), Error);
}

}  // namespace
}  // namespace standoff::fly
